#include "tools/io/input_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "core/errors.h"
#include "core/read_file.h"
#include "core/text_scanner.h"
#include "tools/io/input_frame.h"
#include "tools/io/parallel_vtk.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 3> kImageEndings{".vti", ".pvti", ".vdb"};
constexpr std::array<std::string_view, 3> kMeshEndings{".obj", ".ply", ".stl"};

std::string ending_of(const fs::path& file) {
  return lower_case(file.extension().string());
}

/// Whether a section of that name with anything in it begins in a legacy file, after numbers that may be
/// binary.
bool has_section(std::string_view bytes, const std::string& name) {
  const std::string start = "\n" + name + " ";
  for (std::size_t at = bytes.find(start); at != std::string_view::npos; at = bytes.find(start, at)) {
    at += start.size();
    if (at < bytes.size() && bytes[at] >= '1' && bytes[at] <= '9') return true;
  }
  return false;
}

InputKind kind_of_legacy(const fs::path& file) {
  constexpr std::size_t kHead = 4096;
  const std::string head = lower_case(read_file(file, kHead));
  if (head.find("dataset structured_points") != std::string::npos) return InputKind::images;
  if (head.find("dataset polydata") == std::string::npos) return InputKind::particles;
  const std::string bytes = read_file(file);
  const bool polygons = has_section(bytes, "POLYGONS") || has_section(bytes, "TRIANGLE_STRIPS");
  return polygons ? InputKind::meshes : InputKind::particles;
}

/// Whether an attribute of that name has a value other than 0 in the text.
bool is_counted(std::string_view text, const std::string& name) {
  const std::string attribute = name + "=\"";
  for (std::size_t at = text.find(attribute); at != std::string_view::npos; at = text.find(attribute, at)) {
    at += attribute.size();
    const char first = at < text.size() ? text[at] : '0';
    if (first >= '1' && first <= '9') return true;
  }
  return false;
}

InputKind kind_of_vtp(const fs::path& file) {
  const std::string head = read_file(file, std::size_t{1} << 20);
  const bool polygons = is_counted(head, "NumberOfPolys") || is_counted(head, "NumberOfStrips");
  return polygons ? InputKind::meshes : InputKind::particles;
}

}  // namespace

InputKind input_kind(const fs::path& file) {
  const std::string ending = ending_of(file);
  if (!is_input_file(file))
    throw InvalidInput({file.string()}, fmt::format("unknown kind of file; expected {}", kInputFileKinds));
  if (std::ranges::count(kImageEndings, ending) > 0) return InputKind::images;
  if (std::ranges::count(kMeshEndings, ending) > 0) return InputKind::meshes;
  if (ending == ".vtk") return kind_of_legacy(file);
  return ending == ".vtp" ? kind_of_vtp(file) : InputKind::particles;
}

InputKind input_kind(std::span<const fs::path> files) {
  std::vector<fs::path> pieces;
  for (const fs::path& file : files) std::ranges::move(pieces_of(file), std::back_inserter(pieces));
  const InputKind kind = input_kind(pieces.front());
  if (files.size() == 1 && !is_parallel_vtk(files.front())) return kind;
  for (const fs::path& piece : pieces) {
    const InputKind other = input_kind(piece);
    const bool is_mesh = other == InputKind::meshes;
    if (is_mesh || ending_of(piece) == ".vdb")
      throw InvalidInput({piece.string()},
                         fmt::format("is a piece of a frame; {} are read from one file a frame",
                                     is_mesh ? "meshes" : ".vdb files"));
    if (other != kind)
      throw InvalidInput({piece.string()}, fmt::format("holds {}; {}, a piece of the same frame, holds {}",
                                                       name_of(kInputKinds, other), pieces.front().string(),
                                                       name_of(kInputKinds, kind)));
  }
  return kind;
}

bool is_input_file(const fs::path& file) {
  const std::string ending = ending_of(file);
  return is_particle_file(file) || std::ranges::count(kImageEndings, ending) > 0 ||
         std::ranges::count(kMeshEndings, ending) > 0;
}

}  // namespace kappaflow
