#include "surface/measure/texture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/split_mix.h"
#include "core/whole_within.h"

namespace kappaflow {
namespace {

constexpr std::array<double, 3> kCream{246, 229, 196};
constexpr std::array<double, 3> kBlue{46, 106, 168};
constexpr double kBrightnessRange = 0.22;  // [1] of a colour: the darkest cube has 1 - kBrightnessRange of it

constexpr std::int64_t kFarthestCube = std::int64_t{1} << 52;  // double tells cubes up to there apart

// In [0, 1), the same for a cube at every call.
double cube_hash(const std::array<std::int64_t, 3>& cube) {
  std::uint64_t bits = 0;
  for (const std::int64_t index : cube) bits = split_mix(bits + static_cast<std::uint64_t>(index));
  return static_cast<double>(bits >> 40) / static_cast<double>(std::uint64_t{1} << 24);
}

Rgb checker_colour(const Vec3& x, double edge) {
  std::array<std::int64_t, 3> cube;
  for (int a = 0; a < 3; ++a) cube[a] = whole_within(std::floor(x[a] / edge), -kFarthestCube, kFarthestCube);
  const bool odd = ((cube[0] + cube[1] + cube[2]) & 1) != 0;
  const double brightness = 1 - kBrightnessRange * cube_hash(cube);
  Rgb colour;
  for (int c = 0; c < 3; ++c)
    colour[c] = static_cast<std::uint8_t>(std::lround(brightness * (odd ? kBlue : kCream)[c]));
  return colour;
}

// r: position in the bounding box, in [-1, 1] on each axis.
Vec2 spherical(const Vec3& r) {
  const double longitude = std::atan2(r.z(), r.x()), latitude = std::atan2(r.y(), std::hypot(r.x(), r.z()));
  return {0.5 + longitude / (2 * std::numbers::pi), 0.5 + latitude / std::numbers::pi};
}

Vec2 boxed(const Vec3& r) {
  int face = 0;
  r.cwiseAbs().maxCoeff(&face);
  return {0.5 + 0.5 * r[face == 0 ? 2 : 0], 0.5 + 0.5 * r[face == 1 ? 2 : 1]};
}

}  // namespace

std::vector<Rgb> checker_colours(std::span<const Vec3> rest_position, double edge) {
  std::vector<Rgb> colours(rest_position.size());
  std::ranges::transform(rest_position, colours.begin(),
                         [&](const Vec3& x) { return checker_colour(x, edge); });
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
  std::vector<Vec2> coordinates(rest_position.size());
  const Vec3 center = 0.5 * (box.lower + box.upper);
  const Vec3 half = (0.5 * (box.upper - box.lower)).cwiseMax(1e-300);  // a flat box maps to its middle
  std::ranges::transform(rest_position, coordinates.begin(), [&](const Vec3& x) -> Vec2 {
    const Vec3 r = (x - center).cwiseQuotient(half);
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

}  // namespace kappaflow
