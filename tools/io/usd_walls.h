// Walls in USD text files: meshes that all frames share, and where they move a transform of each a frame.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/types.h"
#include "tools/io/usd_file.h"

namespace kappaflow {

/// A wall where it is at the start, and the point that its transforms turn it about.
struct UsdWall {
  TriangleSurface surface;
  Vec3 middle = Vec3::Zero();  ///< mean of the vertices at the start [m]
};
std::vector<UsdWall> usd_walls(std::span<const TriangleSurface> walls);

/// The meshes, with a normal a face: prims /Walls/wall_0 and so on. moving: each is about its middle, to be
/// put in place by its transform; else where it is, from the stage's origin.
std::string usd_wall_meshes(const UsdStage& stage, std::span<const UsdWall> walls, bool moving);

/// The transforms of a frame of moving walls, which take each to where `now` has its vertices.
std::string usd_walls_frame(int frame, std::span<const UsdWall> walls, std::span<const TriangleSurface> now,
                            const Vec3& origin);
std::string usd_walls_manifest(std::size_t count);

/// The root; meshes: the file of usd_wall_meshes(). moving: else the prim needs no stem and manifest.
std::string usd_walls_root(const UsdStage& stage, const UsdPrim& prim, const std::string& meshes,
                           bool moving);

}  // namespace kappaflow
