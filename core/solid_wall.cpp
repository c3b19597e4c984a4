#include "core/solid_wall.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/errors.h"

namespace kappaflow {

SolidWall::SolidWall(TriangleSurface surface, BodyMotion motion) : motion_(std::move(motion)) {
  auto parts = std::make_shared<Parts>();
  for (const TriangleSurface& solid : solids_of(surface)) {
    parts->solids.emplace_back(solid);
    Eigen::AlignedBox3d& box = parts->boxes.emplace_back();
    for (const Vec3& x : solid.vertices) box.extend(x);
  }
  parts->surface = std::move(surface);
  parts_ = std::move(parts);
}

std::vector<SolidWall> solid_walls(std::span<const TriangleSurface> surfaces,
                                   std::span<const BodyMotion> motions) {
  if (!motions.empty() && motions.size() != surfaces.size())
    throw InvalidInput(fmt::format("{} walls but {} motions", surfaces.size(), motions.size()));
  std::vector<SolidWall> walls;
  for (std::size_t w = 0; w < surfaces.size(); ++w)
    walls.emplace_back(surfaces[w], motions.empty() ? BodyMotion() : motions[w]);
  return walls;
}

std::vector<SolidWall> walls_at(double time, std::span<const SolidWall> walls) {
  std::vector<SolidWall> now;
  for (const SolidWall& wall : walls)
    now.push_back(wall.motion().at_rest() ? wall
                                          : SolidWall(moved(wall.surface(), wall.motion().pose(time))));
  return now;
}

SurfacePoint nearest_of_walls(std::span<const SolidWall> walls, const Vec3& x) {
  SurfacePoint best = nearest_of_union({}, x);
  for (const SolidWall& wall : walls)
    if (const SurfacePoint point = nearest_of_union(wall.solids(), x); point.distance < best.distance)
      best = point;
  return best;
}

std::vector<TriangleSurface> surfaces_of(std::span<const SolidWall> walls) {
  std::vector<TriangleSurface> surfaces;
  for (const SolidWall& wall : walls) surfaces.push_back(wall.surface());
  return surfaces;
}

bool any_moves(std::span<const SolidWall> walls) {
  return std::ranges::any_of(walls, [](const SolidWall& wall) { return !wall.motion().at_rest(); });
}

}  // namespace kappaflow
