#include "tools/io/vdb_file.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/FastSweeping.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <vector>

#include "core/errors.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;
using openvdb::FloatGrid;

struct VdbFile {
  openvdb::GridPtrVec grids;
  openvdb::MetaMap::Ptr metadata;
};

VdbFile read_grids(const fs::path& file) {
  openvdb::initialize();
  if (!fs::is_regular_file(file)) throw IoError(file.string(), "there is no such file");
  try {
    openvdb::io::File source(file.string());
    source.open(false);  // values are read now, not when they are asked for
    VdbFile read{*source.getGrids(), source.getMetadata()};
    source.close();
    return read;
  } catch (const std::exception& error) {  // of OpenVDB's, and of memory that a damaged file asks for
    throw IoError(file.string(), fmt::format("is damaged or not complete ({})", error.what()));
  }
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// The only grid that `fits`; null where there are none or several.
template <class Fits>
FloatGrid::Ptr only_grid(const std::vector<FloatGrid::Ptr>& grids, const Fits& fits) {
  FloatGrid::Ptr found;
  for (const FloatGrid::Ptr& grid : grids) {
    if (!fits(*grid)) continue;
    if (found) return nullptr;
    found = grid;
  }
  return found;
}

FloatGrid::Ptr chosen_grid(const openvdb::GridPtrVec& all, const fs::path& file) {
  std::vector<FloatGrid::Ptr> grids;
  std::string names;
  for (const openvdb::GridBase::Ptr& grid : all) {
    names += (names.empty() ? "" : ", ") + grid->getName();
    if (const auto floats = openvdb::gridPtrCast<FloatGrid>(grid)) grids.push_back(floats);
  }
  for (const char* const name : {"surface", "phi", "sdf"})
    if (const auto named = only_grid(grids, [&](const FloatGrid& g) { return lower(g.getName()) == name; }))
      return named;
  const auto is_level_set = [](const FloatGrid& g) { return g.getGridClass() == openvdb::GRID_LEVEL_SET; };
  if (const auto level_set = only_grid(grids, is_level_set)) return level_set;
  if (const auto only = only_grid(grids, [](const FloatGrid&) { return true; })) return only;
  throw InvalidInput({file.string()},
                     fmt::format("which of its grids is the signed distance is not clear: {}; expected one "
                                 "of the names surface, phi, sdf, or a single grid of floats",
                                 names.empty() ? "none" : names));
}

void check_transform(const FloatGrid& grid, const fs::path& file) {
  const openvdb::math::Transform& transform = grid.transform();
  const openvdb::Vec3d x0 = transform.indexToWorld(openvdb::Vec3d(0)), size = grid.voxelSize();
  const auto is_along = [&](const openvdb::Vec3d& axis) {
    return (transform.indexToWorld(axis) - x0 - axis * size[0]).length() <= 1e-6 * size[0];
  };
  if (!transform.isLinear() || !is_along({1, 0, 0}) || !is_along({0, 1, 0}) || !is_along({0, 0, 1}))
    throw InvalidInput({file.string()},
                       fmt::format("the transform of its grid \"{}\" is none of a uniform scale and a "
                                   "translation",
                                   grid.getName()));
}

std::optional<double> time_in(const openvdb::MetaMap& metadata) {
  for (auto entry = metadata.beginMeta(); entry != metadata.endMeta(); ++entry) {
    if (lower(entry->first) != "time") continue;
    if (const auto* single = dynamic_cast<const openvdb::FloatMetadata*>(entry->second.get()))
      return single->value();
    if (const auto* twice = dynamic_cast<const openvdb::DoubleMetadata*>(entry->second.get()))
      return twice->value();
  }
  return std::nullopt;
}

/// The grid with distances that many voxels beyond those that it has.
FloatGrid::Ptr with_wide_band(const FloatGrid& grid, const fs::path& file) {
  if (grid.activeVoxelCount() == 0)
    throw InvalidInput({file.string()}, fmt::format("its grid \"{}\" has no surface", grid.getName()));
  return openvdb::tools::dilateSdf(grid, kVdbReach, openvdb::tools::NN_FACE_EDGE_VERTEX);
}

/// All values of the box, along x first; where there is no distance, the largest that there is.
std::vector<float> dense_values(const FloatGrid& grid, const openvdb::CoordBBox& box) {
  float largest = 0;
  for (auto value = grid.cbeginValueOn(); value; ++value)
    if (std::isfinite(*value)) largest = std::max(largest, std::abs(*value));
  openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(box);
  openvdb::tools::copyToDense(grid, dense);
  std::vector<float> values(dense.data(), dense.data() + box.volume());
  for (float& value : values) value = std::clamp(value, -largest, largest);
  return values;
}

}  // namespace

ImageFrame read_vdb(const fs::path& file) {
  const VdbFile read = read_grids(file);
  const FloatGrid::Ptr grid = chosen_grid(read.grids, file);
  check_transform(*grid, file);
  const FloatGrid::Ptr wide = with_wide_band(*grid, file);
  const openvdb::CoordBBox box = wide->evalActiveVoxelBoundingBox();
  if (box.volume() > std::uint64_t{1} << 31)
    throw InvalidInput({file.string()}, fmt::format("takes {} x {} x {} points; at most 2^31 will do",
                                                    box.dim().x(), box.dim().y(), box.dim().z()));
  ImageFrame frame;
  frame.value = dense_values(*wide, box);
  const auto [least, most] = std::minmax_element(frame.value.begin(), frame.value.end());
  if (!(*least < 0 && *most > 0))
    throw InvalidInput({file.string()}, fmt::format("its grid \"{}\" has no surface", grid->getName()));
  const openvdb::Vec3d origin = wide->indexToWorld(box.min());
  for (int c = 0; c < 3; ++c) {
    frame.dims[static_cast<std::size_t>(c)] = box.dim()[c];
    frame.origin[c] = origin[c];
    frame.spacing[c] = wide->voxelSize()[0];
  }
  frame.name = grid->getName();
  frame.time = time_in(*grid);
  if (!frame.time) frame.time = time_in(*read.metadata);
  return frame;
}

}  // namespace kappaflow
