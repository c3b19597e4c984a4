#include "tools/io/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/errors.h"
#include "core/read_file.h"
#include "core/text_scanner.h"
#include "tools/io/image_pieces.h"
#include "tools/io/legacy_vtk.h"
#include "tools/io/parallel_vtk.h"
#include "tools/io/vdb_file.h"
#include "tools/io/vtk_xml.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

const std::initializer_list<std::string_view> kDistanceNames{
    "phi", "sdf", "distance", "signed_distance", "levelset", "level_set", "surface", "ls"};
const std::initializer_list<std::string_view> kFlowNames{"velocity", "vel", "u", "v"};

/// A single component that is no mark of VTK's own.
bool is_scalar(const PointArray& array) {
  return array.components == 1 && !array.name.starts_with("vtk");
}

std::string array_names(const LatticeData& image) {
  std::string names;
  for (const auto* arrays : {&image.arrays, &image.cell_arrays})
    for (const PointArray& array : *arrays)
      names += fmt::format("{}{}", names.empty() ? "" : ", ", one_line(array.name, 30));
  return names.empty() ? "none" : names;
}

/// The distance among the arrays of points or of cells; null where it is not there.
const PointArray* find_distance(const std::vector<PointArray>& arrays, const LatticeData& image) {
  if (const PointArray* named = find_array(arrays, kDistanceNames, 1)) return named;
  if (std::ranges::count_if(image.arrays, is_scalar) + std::ranges::count_if(image.cell_arrays, is_scalar) !=
      1)
    return nullptr;
  const auto only = std::ranges::find_if(arrays, is_scalar);
  return only == arrays.end() ? nullptr : &*only;
}

std::string point_text(std::size_t i, const ImageFrame& frame) {
  const auto nx = static_cast<std::size_t>(frame.dims[0]), ny = static_cast<std::size_t>(frame.dims[1]);
  return fmt::format("({}, {}, {})", i % nx, i / nx % ny, i / nx / ny);
}

void check_numbers(const ImageFrame& frame) {
  for (std::size_t i = 0; i < frame.value.size(); ++i) check_number(frame, i);
  if (frame.time && !std::isfinite(*frame.time))
    throw InvalidInput(fmt::format("its time is {} s; it must be finite", *frame.time));
}

void check_spacing(const Vec3& origin, const Vec3& spacing) {
  if (!origin.allFinite() || !spacing.allFinite() || !(spacing.minCoeff() > 0))
    throw InvalidInput(
        fmt::format("its origin is ({}), its spacing ({}); expected finite numbers, and a "
                    "spacing above 0",
                    fmt::join(origin, ", "), fmt::join(spacing, ", ")));
}

void check_lattice(const ImageFrame& frame) {
  if (std::ranges::min(frame.dims) < ImageFrame::kLeastPoints)
    throw InvalidInput(fmt::format("has {} values; expected at least {} along each axis",
                                   fmt::join(frame.dims, " x "), ImageFrame::kLeastPoints));
  check_spacing(frame.origin, frame.spacing);
}

void check_axes(const LatticeData& image) {
  if (image.turned) throw InvalidInput("has a direction matrix; expected rows along x, y and z");
}

/// Which of the values belong to other pieces as well; empty where the file does not say.
std::vector<bool> ghosts_in(const std::vector<PointArray>& arrays) {
  std::vector<bool> ghost;
  if (const PointArray* mark = find_array(arrays, {"vtkghosttype", "vtkghostlevels"}, 1))
    for (const double value : mark->values) ghost.push_back(value != 0);
  return ghost;
}

ImagePiece piece_from(const LatticeData& image) {
  check_axes(image);
  const PointArray* distance = find_distance(image.arrays, image);
  const bool of_cells = distance == nullptr;
  if (of_cells) distance = find_distance(image.cell_arrays, image);
  if (distance == nullptr)
    throw InvalidInput(fmt::format(
        "which of its arrays is the signed distance is not clear: {}; expected one of the names {}, or a "
        "single array of one component",
        array_names(image), fmt::join(kDistanceNames, ", ")));
  ImagePiece piece;
  piece.of_cells = of_cells;
  piece.ghost = ghosts_in(of_cells ? image.cell_arrays : image.arrays);
  ImageFrame& frame = piece.frame;
  for (std::size_t c = 0; c < 3; ++c) frame.dims[c] = static_cast<int>(image.points[c]) - (of_cells ? 1 : 0);
  frame.spacing = image.spacing;
  frame.origin = image.origin;
  if (of_cells) frame.origin += 0.5 * image.spacing;
  frame.name = distance->name;
  frame.value.assign(distance->values.begin(), distance->values.end());
  if (const PointArray* velocity = find_array(of_cells ? image.cell_arrays : image.arrays, kFlowNames, 3)) {
    frame.velocity_name = velocity->name;
    frame.velocity.reserve(velocity->values.size() / 3);
    for (std::size_t i = 0; i < velocity->values.size(); i += 3)
      frame.velocity.emplace_back(Vec3(&velocity->values[i]).cast<float>());
  }
  frame.time = time_in(image.fields);
  return piece;
}

LatticeData read_lattice(const fs::path& file, bool legacy) {
  const std::string bytes = read_file(file);
  try {
    return legacy ? parse_legacy_image(bytes) : parse_vtk_image(bytes);
  } catch (const InvalidInput& error) {
    throw IoError(file.string(), fmt::format("is damaged or not complete ({})", error.what()));
  }
}

/// As the file has it, of whatever size.
ImagePiece read_lone(const fs::path& file, const std::string& kind) {
  if (kind == ".vdb") return {.file = file, .frame = read_vdb(file)};
  const LatticeData image = read_lattice(file, kind == ".vtk");
  try {
    ImagePiece piece = piece_from(image);
    check_spacing(piece.frame.origin, piece.frame.spacing);
    piece.file = file;
    return piece;
  } catch (const InvalidInput& error) {
    throw InvalidInput({file.string()}, error.what());
  }
}

/// The image whose pieces the file lists.
ImagePiece read_listed(const fs::path& file) {
  const std::string bytes = read_file(file);
  VtkImageList list;
  try {
    list = parse_vtk_image_list(bytes);
  } catch (const InvalidInput& error) {
    throw IoError(file.string(), fmt::format("is damaged or not complete ({})", error.what()));
  }
  try {
    check_axes(list.lattice);
    check_spacing(list.lattice.origin, list.lattice.spacing);
  } catch (const InvalidInput& error) {
    throw InvalidInput({file.string()}, error.what());
  }
  std::vector<ImagePiece> pieces;
  for (const VtkImageList::Piece& piece : list.pieces) {
    pieces.push_back(read_lone(piece_of(file, piece.source), ".vti"));
    pieces.back().points = piece.extent;
  }
  ImagePiece image =
      join_pieces(pieces, ImageLattice{list.lattice.origin, list.lattice.spacing, list.whole}, file);
  if (!image.frame.time) image.frame.time = time_in(list.lattice.fields);
  return image;
}

ImagePiece read_image_piece(const fs::path& file) {
  const std::string kind = lower_case(file.extension().string());
  if (kind != ".vti" && kind != ".pvti" && kind != ".vtk" && kind != ".vdb")
    throw InvalidInput({file.string()}, "unknown kind of image; expected .vti, .pvti, .vtk or .vdb");
  return kind == ".pvti" ? read_listed(file) : read_lone(file, kind);
}

}  // namespace

void check_number(const ImageFrame& frame, std::size_t i) {
  if (!std::isfinite(frame.value[i]))
    throw InvalidInput(fmt::format("\"{}\" of point {} is {}; it must be finite", frame.name,
                                   point_text(i, frame), frame.value[i]));
  if (!frame.velocity.empty() && !frame.velocity[i].allFinite())
    throw InvalidInput(fmt::format("\"{}\" of point {} is ({}); it must be finite", frame.velocity_name,
                                   point_text(i, frame), fmt::join(frame.velocity[i], ", ")));
}

ImageFrame read_image(std::span<const fs::path> files) {
  std::vector<ImagePiece> pieces;
  for (const fs::path& file : files) pieces.push_back(read_image_piece(file));
  ImageFrame frame = pieces.size() == 1 ? std::move(pieces.front().frame)
                                        : join_pieces(pieces, std::nullopt, files.front()).frame;
  try {
    check_lattice(frame);
    check_numbers(frame);
  } catch (const InvalidInput& error) {
    throw InvalidInput({files.front().string()}, error.what());
  }
  return frame;
}

ImageFrame read_image(const fs::path& file) {
  return read_image({&file, 1});
}

}  // namespace kappaflow
