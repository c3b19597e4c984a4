// Walls and blocks of liquid for the solver's tests.
#pragma once

#include <cmath>
#include <vector>

#include "core/types.h"

namespace kappaflow::test {

/// A box as 12 triangles, oriented outward.
inline TriangleSurface box_surface(const Vec3& lower, const Vec3& upper) {
  TriangleSurface s;
  for (int i = 0; i < 8; ++i)
    s.vertices.emplace_back(i & 1 ? upper.x() : lower.x(), i & 2 ? upper.y() : lower.y(),
                            i & 4 ? upper.z() : lower.z());
  s.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return s;
}

/// Five boxes around the open-topped space [0, width] x [0, height] x [0, width].
inline std::vector<TriangleSurface> container(double width, double height, double thickness) {
  const double a = -thickness, b = width + thickness;
  return {box_surface({a, a, a}, {b, 0, b}), box_surface({a, a, a}, {0, height, b}),
          box_surface({width, a, a}, {b, height, b}), box_surface({a, a, a}, {b, height, 0}),
          box_surface({a, a, width}, {b, height, b})};
}

/// Stairs down along +x as overlapping boxes: a landing with its top at y = steps * rise for x in [-1, 0],
/// treads of length `run`, then a floor at y = 0 of length 1; z in [-width/2, width/2].
inline std::vector<TriangleSurface> stairs(int steps, double rise, double run, double width) {
  std::vector<TriangleSurface> boxes;
  for (int i = 0; i <= steps; ++i) {
    const double x = i == 0 ? -1 : (i - 1) * run, end = i == steps ? x + 1 : i * run;
    boxes.push_back(box_surface({x, -0.5, -width / 2}, {end, (steps - i) * rise, width / 2}));
  }
  return boxes;
}

/// The cubic lattice of `spacing` that fills the box, its outermost points half a spacing inside.
inline std::vector<Vec3> block(const Vec3& lower, const Vec3& upper, double spacing) {
  const Eigen::Array3d count = ((upper - lower) / spacing).array().round();
  std::vector<Vec3> points;
  for (int k = 0; k < count.z(); ++k)
    for (int j = 0; j < count.y(); ++j)
      for (int i = 0; i < count.x(); ++i) points.push_back(lower + spacing * Vec3(i + 0.5, j + 0.5, k + 0.5));
  return points;
}

/// A ball of lattice points about the origin, each moved by up to a tenth of the spacing in a fixed irregular
/// way.
inline std::vector<Vec3> blob(double radius, double spacing) {
  std::vector<Vec3> points;
  for (const Vec3& x : block(Vec3::Constant(-radius), Vec3::Constant(radius), spacing)) {
    const double s = 1000 * x.dot(Vec3(1.3, 2.7, 4.1)) / spacing;
    if (x.norm() < radius)
      points.push_back(x + 0.1 * spacing * Vec3(std::sin(s), std::sin(2 * s), std::sin(3 * s)));
  }
  return points;
}

/// A thread four spacings thick that runs to and fro along x four times, 32 spacings long, eight apart.
inline std::vector<Vec3> winding(double spacing) {
  std::vector<Vec3> points;
  const auto add_block = [&](const Vec3& lower, const Vec3& upper) {
    for (const Vec3& x : block(spacing * lower, spacing * upper, spacing)) points.push_back(x);
  };
  for (int row = 0; row < 4; ++row) {
    const double y = 8 * row, end = row % 2 == 0 ? 28 : 0;
    add_block({0, y, 0}, {32, y + 4, 4});
    if (row < 3) add_block({end, y + 4, 0}, {end + 4, y + 8, 4});
  }
  return points;
}

}  // namespace kappaflow::test
