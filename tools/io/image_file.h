// Signed distances on a lattice, as a solver on a grid writes them. C++17, see vdb_file.h.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// Values on a regular lattice at one instant, along x first, then along y.
struct ImageFrame {
  std::array<int, 3> dims{};                ///< points along x, y, z, at least kLeastPoints
  Vec3 origin = Vec3::Zero();               ///< of the first point [m]
  Vec3 spacing = Vec3::Ones();              ///< between points [m], > 0
  std::vector<float> value{};               ///< signed distance [m], finite, as in the file: negative inside
  std::vector<Eigen::Vector3f> velocity{};  ///< [m/s], finite, one a point; empty where the file has none
  std::optional<double> time{};             ///< [s], where the file says it
  std::string name{}, velocity_name{};      ///< what the file calls them; empty where it lacks them

  static constexpr int kLeastPoints = 4;
};

/// Reads, by the ending of the name,
///   .vti  VTK XML image data
///   .pvti  parallel VTK XML: the pieces that it lists, relative to it, see join_pieces()
///   .vtk  legacy VTK, structured points
///   .vdb  OpenVDB, see read_vdb()
/// The distance is the first array of one component with one of the names phi, sdf, distance,
/// signed_distance, levelset, level_set, surface and ls, in upper or lower case, else the only array of one
/// component; the velocity the array velocity, vel, u or v of three components beside it. They belong to
/// points or to cells; of cells, these are at the centres. Throws IoError (not readable, not complete, a
/// piece is not there), InvalidInput (no distance or several, fewer than kLeastPoints along an axis, axes
/// that are not x, y and z, a spacing that is not positive, a number that is not finite, pieces that do not
/// fit).
ImageFrame read_image(const std::filesystem::path& file);

/// Throws InvalidInput where one of the numbers of point i is not finite.
void check_number(const ImageFrame& frame, std::size_t i);

}  // namespace kappaflow
