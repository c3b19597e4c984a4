#include "surface/mesh/mesh_measures.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/connectivity.h"
#include "core/errors.h"
#include "core/parallel.h"
#include "core/triangle_geometry.h"

namespace kappaflow {
namespace {

/// Smallest and largest angle [degrees].
std::array<double, 2> angle_range(std::span<const Vec3> position, const Triangle& triangle) {
  std::array<double, 2> range{std::numbers::pi, 0};
  for (int corner = 0; corner < 3; ++corner) {
    const double angle = angle_at(position[triangle[corner]], position[triangle[(corner + 1) % 3]],
                                  position[triangle[(corner + 2) % 3]]);
    range = {std::min(range[0], angle), std::max(range[1], angle)};
  }
  return {180 / std::numbers::pi * range[0], 180 / std::numbers::pi * range[1]};
}

/// Longest edge over shortest altitude in units of the equilateral triangle's, whose is 2/sqrt(3).
double aspect_ratio(const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::sqrt(3.0) / 2 * longest_edge_squared(a, b, c) / (2 * triangle_area(a, b, c));
}

/// The smallest vertex of an edge whose sides do not fit; -1 without any.
int first_open_vertex(std::span<const Triangle> triangles) {
  const std::vector<int> twin = twins_of(triangles);
  int first = -1;
  for (int h = 0; h < static_cast<int>(twin.size()); ++h) {
    if (twin[h] >= 0) continue;
    const int v = std::min(origin_of(triangles, h), end_of(triangles, h));
    first = first < 0 ? v : std::min(first, v);
  }
  return first;
}

}  // namespace

void vertex_areas(std::span<const Vec3> position, std::span<const Triangle> triangles,
                  std::span<double> area) {
  std::fill(area.begin(), area.end(), 0.0);
  for (const Triangle& t : triangles) {
    const double third = triangle_area(position[t[0]], position[t[1]], position[t[2]]) / 3;
    for (const int v : t) area[v] += third;
  }
}

std::vector<double> vertex_areas(std::span<const Vec3> position, std::span<const Triangle> triangles) {
  std::vector<double> area(position.size());
  vertex_areas(position, triangles, area);
  return area;
}

AreaAndVolume area_and_volume(std::span<const Vec3> position, std::span<const Triangle> triangles) {
  if (triangles.empty()) return {};
  // Tetrahedra with a vertex of the mesh, not the origin, as their apex: far from the origin volumes would
  // cancel.
  const Vec3 apex = position[triangles[0][0]];
  const Vec2 sum = parallel_sum(triangles.size(), Vec2(Vec2::Zero()), [&](std::size_t i) -> Vec2 {
    const Vec3 a = position[triangles[i][0]] - apex, b = position[triangles[i][1]] - apex,
               c = position[triangles[i][2]] - apex;
    return {triangle_area(a, b, c), a.dot(b.cross(c)) / 6};
  });
  return {.area = sum[0], .volume = sum[1]};
}

double triangle_quality(const Vec3& a, const Vec3& b, const Vec3& c) {
  // 16 area^2 = (a+b+c)(b+c-a)(c+a-b)(a+b-c) turns 8 (s-a)(s-b)(s-c)/(abc) into this, which does not cancel.
  const double la = (c - b).norm(), lb = (a - c).norm(), lc = (b - a).norm();
  const double product = la * lb * lc;
  if (!(product > 0)) return 0;
  return 4 * twice_area_vector(a, b, c).squaredNorm() / (product * (la + lb + lc));
}

QualityRange triangle_qualities(std::span<const Vec3> position, std::span<const Triangle> triangles) {
  if (triangles.empty()) return {};
  const QualityRange range = parallel_reduce(
      triangles.size(), QualityRange{.min = 1, .mean = 0},
      [&](std::size_t i) -> QualityRange {
        const double quality =
            triangle_quality(position[triangles[i][0]], position[triangles[i][1]], position[triangles[i][2]]);
        return {quality, quality};
      },
      [](const QualityRange& a, const QualityRange& b) -> QualityRange {
        return {std::min(a.min, b.min), a.mean + b.mean};
      });
  return {range.min, range.mean / static_cast<double>(triangles.size())};
}

double smallest_angle(std::span<const Vec3> position, std::span<const Triangle> triangles) {
  // The smallest angle of a triangle is at most 60 degrees.
  return parallel_reduce(
      triangles.size(), 60.0, [&](std::size_t t) { return angle_range(position, triangles[t])[0]; },
      [](double a, double b) { return std::min(a, b); });
}

double angles_outside(std::span<const Vec3> position, std::span<const Triangle> triangles, double smallest,
                      double largest) {
  if (triangles.empty()) return 0;
  const double outside = parallel_sum(triangles.size(), 0.0, [&](std::size_t t) {
    const auto [least, most] = angle_range(position, triangles[t]);
    return least < smallest || most > largest ? 1.0 : 0.0;
  });
  return outside / static_cast<double>(triangles.size());
}

TriangleDistortion triangle_distortion(std::span<const Vec3> position, std::span<const Vec3> rest_position,
                                       std::span<const Triangle> triangles) {
  if (triangles.empty()) return {};
  const TriangleDistortion sums = parallel_reduce(
      triangles.size(), TriangleDistortion{0, 0, std::numeric_limits<double>::infinity(), 0},
      [&](std::size_t i) -> TriangleDistortion {
        const auto& [a, b, c] = triangles[i];
        const double area = triangle_area(position[a], position[b], position[c]);
        const double ratio = area / triangle_area(rest_position[a], rest_position[b], rest_position[c]);
        const double aspect = aspect_ratio(position[a], position[b], position[c]);
        return {aspect, aspect, ratio, ratio};
      },
      [](const TriangleDistortion& a, const TriangleDistortion& b) -> TriangleDistortion {
        return {a.aspect_mean + b.aspect_mean, std::max(a.aspect_max, b.aspect_max),
                std::min(a.area_ratio_min, b.area_ratio_min), std::max(a.area_ratio_max, b.area_ratio_max)};
      });
  return {sums.aspect_mean / static_cast<double>(triangles.size()), sums.aspect_max, sums.area_ratio_min,
          sums.area_ratio_max};
}

bool is_delaunay(const Vec3& u, const Vec3& v, const Vec3& a, const Vec3& b) {
  constexpr double kMargin = 1e-9;  // [1] of the sum of cotangents: rounding flips no edge to and fro
  const bool both_acute =
      (u - a).dot(v - a) >= 0 && (u - b).dot(v - b) >= 0;  // most are: the cheaper question
  return both_acute || !(cotangent_at(a, u, v) + cotangent_at(b, u, v) < -kMargin);
}

double facing(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal_sum) {
  const Vec3 area = twice_area_vector(a, b, c);
  const double size = area.norm() * normal_sum.norm();
  return size > 0 ? area.dot(normal_sum) / size : -1;
}

double folded_fraction(std::span<const Vec3> position, std::span<const Vec3> normal,
                       std::span<const Triangle> triangles) {
  if (triangles.empty()) return 0;
  const double folded = parallel_sum(triangles.size(), 0.0, [&](std::size_t i) {
    const auto& [a, b, c] = triangles[i];
    const Vec3 outward = twice_area_vector(position[a], position[b], position[c]);
    return outward.dot(normal[a] + normal[b] + normal[c]) < 0 ? 1.0 : 0.0;
  });
  return folded / static_cast<double>(triangles.size());
}

MeshTopology mesh_topology(std::span<const Vec3> position, std::span<const Triangle> triangles) {
  if (const int open = first_open_vertex(triangles); open >= 0)
    throw TopologyError(position[open],
                        "the mesh is not closed and oriented: an edge here does not have two triangles "
                        "that run along it in opposite directions");
  std::vector<char> used(position.size(), 0);
  for (const Triangle& t : triangles)
    for (const int v : t) used[v] = 1;
  const int faces = static_cast<int>(triangles.size()), edges = 3 * faces / 2,
            vertices = static_cast<int>(std::ranges::count(used, 1));
  const std::vector<int> piece = vertex_pieces(position.size(), triangles);
  const int pieces = piece.empty() ? 0 : std::ranges::max(piece) + 1,
            components = pieces - (static_cast<int>(used.size()) - vertices);
  return {.components = components, .genus = components - (vertices - edges + faces) / 2};
}

}  // namespace kappaflow
