#include "scenes/rigid_bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace kappaflow {
namespace {

constexpr double kTouching = 0.05;      // how deep solids may be in one another [spacings]
constexpr double kFinestShare = 0.002;  // of the solid's size, that large ones end too
constexpr double kFinestPiece = 0.5;    // of triangles, where solids are at least a spacing thick [spacings]

using Corners = std::array<Vec3, 3>;

/// Whether a point of the triangle is deeper than `allowed` in the solid. A piece that is nowhere near the
/// solid's surface is outside or inside as its middle is; others are halved.
bool reaches_into(const Corners& corners, const SolidWall& solid, double allowed, double finest) {
  const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3;
  const double distance = nearest_of_union(solid.solids(), middle).distance;
  double radius = 0;
  for (const Vec3& corner : corners) radius = std::max(radius, (corner - middle).norm());
  if (distance < -allowed) return true;
  if (distance - radius >= -allowed || radius <= finest) return false;
  std::size_t longest = 0;
  const auto length = [&](std::size_t edge) { return (corners[(edge + 1) % 3] - corners[edge]).norm(); };
  for (const std::size_t edge : {1, 2})
    if (length(edge) > length(longest)) longest = edge;
  const std::size_t next = (longest + 1) % 3;
  Corners first = corners, second = corners;
  first[next] = second[longest] = (corners[longest] + corners[next]) / 2;
  return reaches_into(first, solid, allowed, finest) || reaches_into(second, solid, allowed, finest);
}

bool surface_reaches_into(const SolidWall& one, const SolidWall& other, double spacing) {
  const TriangleSurface& surface = one.surface();
  const double allowed = kTouching * spacing;
  Eigen::AlignedBox3d box;
  for (const Eigen::AlignedBox3d& part : one.boxes()) box.extend(part);
  const double finest = std::max(kFinestPiece * spacing, kFinestShare * box.diagonal().norm());
  const auto deep = [&](const Vec3& x) { return nearest_of_union(other.solids(), x).distance < -allowed; };
  if (std::ranges::any_of(surface.vertices, deep)) return true;
  return std::ranges::any_of(surface.triangles, [&](const Triangle& t) {
    return reaches_into({surface.vertices[t[0]], surface.vertices[t[1]], surface.vertices[t[2]]}, other,
                        allowed, finest);
  });
}

bool boxes_meet(const SolidWall& one, const SolidWall& other) {
  return std::ranges::any_of(one.boxes(), [&](const Eigen::AlignedBox3d& box) {
    return std::ranges::any_of(other.boxes(), [&](const auto& beside) { return box.intersects(beside); });
  });
}

/// One may also lie within the other as a whole, with no part of its surface in the first.
bool overlap(const SolidWall& one, const SolidWall& other, double spacing) {
  return boxes_meet(one, other) &&
         (surface_reaches_into(one, other, spacing) || surface_reaches_into(other, one, spacing));
}

}  // namespace

void check_apart(const Scene& scene, std::span<const SolidWall> walls, std::span<const RigidBody> bodies) {
  const double spacing = scene.fluid.spacing;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const SolidWall& body = bodies[b].solid;
    const auto refuse = [&](std::string_view other, const SourcePosition& where) {
      throw InvalidInput(scene.bodies[b].where,
                         fmt::format("the body is in the {} of line {}; allowed: bodies that are no deeper "
                                     "than {} spacings, {:.6g} m, in walls and other bodies",
                                     other, where.line, kTouching, kTouching * spacing));
    };
    for (std::size_t w = 0; w < walls.size(); ++w)
      if (overlap(body, walls[w], spacing)) refuse("wall", scene.walls[w].where);
    for (std::size_t other = 0; other < b; ++other)
      if (overlap(body, bodies[other].solid, spacing)) refuse("body", scene.bodies[other].where);
  }
}

}  // namespace kappaflow
