#include "surface/measure/texture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/whole_within.h"

namespace kappaflow {
namespace {

constexpr std::array<double, 3> kCream{246, 229, 196};
constexpr std::array<double, 3> kBlue{46, 106, 168};
constexpr double kBrightnessRange = 0.22;  // [1] of a colour: the darkest cube has 1 - kBrightnessRange of it

constexpr int kFarthestCube = 1 << 29;  // whole numbers add up without overflow up to there
constexpr int kPhases = 16;             // of a cube's edge, at which planes are tried
constexpr double kNear = 0.25;          // distance from a plane in cubes that counts
constexpr int kFacingPower = 8;         // of the normal's component: what faces along the axis counts

// In [0, 1), the same for a cube at every call, and simple enough for shaders:
// tools/pictures/texture_colours.glsl does the same.
double cube_hash(const std::array<int, 3>& cube) {
  std::uint32_t bits = static_cast<std::uint32_t>(cube[0]) * 73856093u ^
                       static_cast<std::uint32_t>(cube[1]) * 19349663u ^
                       static_cast<std::uint32_t>(cube[2]) * 83492791u;
  bits = (bits ^ (bits >> 13)) * 1540483477u;
  bits ^= bits >> 15;
  return static_cast<double>(bits >> 8) / static_cast<double>(1u << 24);
}

/// x: in cubes.
Rgb cube_colour(const Vec3& x) {
  std::array<int, 3> cube;
  for (int a = 0; a < 3; ++a) cube[a] = whole_within(std::floor(x[a]), -kFarthestCube, kFarthestCube);
  const bool odd = ((cube[0] + cube[1] + cube[2]) & 1) != 0;
  const double brightness = 1 - kBrightnessRange * cube_hash(cube);
  Rgb colour;
  for (int c = 0; c < 3; ++c)
    colour[c] = static_cast<std::uint8_t>(std::lround(brightness * (odd ? kBlue : kCream)[c]));
  return colour;
}

/// How much of the surface faces along the axis near planes at origin + whole cubes.
double planes_in_surface(std::span<const Vec3> position, std::span<const Vec3> normal, int axis,
                         double origin, double edge) {
  double sum = 0;
  for (std::size_t v = 0; v < position.size(); ++v) {
    const double x = (position[v][axis] - origin) / edge, distance = std::abs(x - std::round(x));
    sum += std::max(0.0, 1 - distance / kNear) * std::pow(std::abs(normal[v][axis]), kFacingPower);
  }
  return sum;
}

// r: position in the bounding box, in [-1, 1] on each axis.
Vec2 spherical(const Vec3& r) {
  const double longitude = std::atan2(r.z(), r.x()), latitude = std::atan2(r.y(), std::hypot(r.x(), r.z()));
  return {0.5 + longitude / (2 * std::numbers::pi), 0.5 + latitude / std::numbers::pi};
}

/// The axis of the two faces that the point is nearest to.
int nearest_face(const Vec3& r) {
  int face = 0;
  r.cwiseAbs().maxCoeff(&face);
  return face;
}

Vec2 on_face(const Vec3& r, int face) {
  return {0.5 + 0.5 * r[face == 0 ? 2 : 0], 0.5 + 0.5 * r[face == 1 ? 2 : 1]};
}

Vec2 boxed(const Vec3& r) {
  return on_face(r, nearest_face(r));
}

std::vector<Vec3> relative_to(const Bounds& box, std::span<const Vec3> position) {
  const Vec3 center = 0.5 * (box.lower + box.upper);
  const Vec3 half = (0.5 * (box.upper - box.lower)).cwiseMax(1e-300);  // a flat box maps to its middle
  std::vector<Vec3> r(position.size());
  std::ranges::transform(position, r.begin(),
                         [&](const Vec3& x) -> Vec3 { return (x - center).cwiseQuotient(half); });
  return r;
}

// A chart is a way to lay out texture coordinates: a face of the box, or of a sphere 1 where longitudes are
// counted on by a turn.
int own_chart(const Vec3& r, TextureProjection projection) {
  return projection == TextureProjection::box ? nearest_face(r) : 0;
}

/// own: the corners' coordinates in their own charts.
std::array<int, 3> corner_charts(const std::array<Vec3, 3>& r, const std::array<Vec2, 3>& own,
                                 TextureProjection projection) {
  std::array<int, 3> charts{};
  if (projection == TextureProjection::box) charts.fill(nearest_face(r[0] + r[1] + r[2]));
  if (projection != TextureProjection::spherical) return charts;
  const double most = std::max({own[0][0], own[1][0], own[2][0]});
  for (int c = 0; c < 3; ++c) charts[c] = most - own[c][0] > 0.5 ? 1 : 0;
  return charts;
}

Vec2 in_chart(const Vec3& r, const Vec2& own, int chart, TextureProjection projection) {
  return projection == TextureProjection::box ? on_face(r, chart) : Vec2(own[0] + chart, own[1]);
}

}  // namespace

Checker checker_beside(std::span<const Vec3> position, std::span<const Vec3> normal, double edge) {
  Checker checker{.edge = edge};
  for (int axis = 0; axis < 3; ++axis) {
    double least = HUGE_VAL;
    for (int k = 0; k < kPhases; ++k) {
      const double origin = edge * k / kPhases,
                   cost = planes_in_surface(position, normal, axis, origin, edge);
      if (!(cost < least)) continue;
      least = cost;
      checker.origin[axis] = origin;
    }
  }
  return checker;
}

std::vector<Rgb> checker_colours(std::span<const Vec3> rest_position, const Checker& checker) {
  std::vector<Rgb> colours(rest_position.size());
  std::ranges::transform(rest_position, colours.begin(),
                         [&](const Vec3& x) { return cube_colour((x - checker.origin) / checker.edge); });
  return colours;
}

Bounds bounding_box(std::span<const Vec3> position) {
  if (position.empty()) return {};
  Bounds box{position[0], position[0]};
  for (const Vec3& x : position) {
    box.lower = box.lower.cwiseMin(x);
    box.upper = box.upper.cwiseMax(x);
  }
  return box;
}

std::vector<Vec2> texture_coordinates(std::span<const Vec3> rest_position, const Bounds& box,
                                      TextureProjection projection) {
  const std::vector<Vec3> relative = relative_to(box, rest_position);
  std::vector<Vec2> coordinates(relative.size());
  std::ranges::transform(relative, coordinates.begin(), [&](const Vec3& r) -> Vec2 {
    switch (projection) {
      case TextureProjection::planar:
        return {0.5 + 0.5 * r.x(), 0.5 + 0.5 * r.y()};
      case TextureProjection::spherical:
        return spherical(r);
      case TextureProjection::box:
        break;
    }
    return boxed(r);
  });
  return coordinates;
}

SeamlessTexture seamless_texture(std::span<const Vec3> rest_position, std::span<const Triangle> triangles,
                                 const Bounds& box, TextureProjection projection) {
  constexpr int kNone = -1, kCharts = 3;
  SeamlessTexture texture{texture_coordinates(rest_position, box, projection), {}};
  const std::vector<Vec3> r = relative_to(box, rest_position);
  std::vector<std::array<int, kCharts>> entry(r.size(), {kNone, kNone, kNone});
  for (std::size_t v = 0; v < r.size(); ++v) entry[v][own_chart(r[v], projection)] = static_cast<int>(v);
  for (const Triangle& t : triangles) {
    const std::array<Vec2, 3> own{texture.value[t[0]], texture.value[t[1]], texture.value[t[2]]};
    const std::array<int, 3> charts = corner_charts({r[t[0]], r[t[1]], r[t[2]]}, own, projection);
    Triangle corners;
    for (int c = 0; c < 3; ++c) {
      corners[c] = entry[t[c]][charts[c]];
      if (corners[c] != kNone) continue;
      corners[c] = entry[t[c]][charts[c]] = static_cast<int>(texture.value.size());
      texture.value.push_back(in_chart(r[t[c]], own[c], charts[c], projection));
    }
    texture.corners.push_back(corners);
  }
  return texture;
}

}  // namespace kappaflow
