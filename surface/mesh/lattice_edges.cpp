#include "surface/mesh/lattice_edges.h"

#include <vtkMarchingCubesTriangleCases.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "core/parallel.h"

namespace kappaflow {
namespace {

// [1] Share of the largest |f| of a plane below which a sample counts as this far from zero. A float has
// seven digits.
constexpr float kSmallestSample = 1e-6f;
constexpr int kFalsePositions = 40;  // evaluations on an edge at most

/// Of a cell, as the tables of marching cubes number them.
constexpr std::array<LatticePoint, 8> kCorners{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

bool is_exact(const ValueAndGradient& at, double tolerance) {
  return std::abs(at.f) <= tolerance * at.g.norm();
}

/// f = 0 near x between two points of an edge, by one step of Newton's method along the edge, which is enough
/// where f is nearly linear along it.
std::optional<LatticeVertex> newton_on_edge(const Field& field, Vec3 x, const Vec3& from, const Vec3& to,
                                            double tolerance) {
  ValueAndGradient at = field.value_and_gradient(x);
  if (!is_exact(at, tolerance)) {
    const Vec3 edge = to - from;
    const double share = edge.dot(x - from) / edge.squaredNorm() - at.f / at.g.dot(edge);
    if (!(share >= 0 && share <= 1)) return std::nullopt;
    x = from + share * edge;
    at = field.value_and_gradient(x);
  }
  if (!is_exact(at, tolerance)) return std::nullopt;
  return LatticeVertex{x, at.g, true};
}

/// The same by false position, wherever it is between the points; where float and double precision differ
/// about the sign at one end, that end.
LatticeVertex false_position_on_edge(const Field& field, const Vec3& from, const Vec3& to, double tolerance) {
  std::array<Vec3, 2> end{from, to};
  std::array<double, 2> f{field.value_and_gradient(from).f, field.value_and_gradient(to).f};
  Vec3 x = std::abs(f[0]) < std::abs(f[1]) ? from : to;
  ValueAndGradient at = field.value_and_gradient(x);
  for (int i = 0, last = -1; i < kFalsePositions && f[0] * f[1] < 0 && (i == 0 || !is_exact(at, tolerance));
       ++i) {
    x = (f[1] * end[0] - f[0] * end[1]) / (f[1] - f[0]);
    at = field.value_and_gradient(x);
    const int side = (at.f > 0) == (f[0] > 0) ? 0 : 1;
    end[side] = x;
    f[side] = at.f;
    if (side == last) f[1 - side] *= 0.5;
    last = side;
  }
  return {x, at.g, is_exact(at, tolerance)};
}

}  // namespace

const int* triangles_of_cell(const SampledField& samples, const LatticePoint& cell) {
  static const vtkMarchingCubesTriangleCases* const cases = vtkMarchingCubesTriangleCases::GetCases();
  int number = 0;
  for (int c = 0; c < 8; ++c)
    number |= (samples.value[point_index(samples, moved(cell, kCorners[c]))] > 0) << c;
  return cases[number].edges;
}

LatticeVertex find_on_edge(const Field& field, const Vec3& x, const Vec3& from, const Vec3& to,
                           double tolerance) {
  const auto found = newton_on_edge(field, x, from, to, tolerance);
  return found ? *found : false_position_on_edge(field, from, to, tolerance);
}

void move_off_zero(SampledField& samples) {
  const std::size_t plane = static_cast<std::size_t>(samples.dims[0]) * samples.dims[1];
  parallel_for(
      static_cast<std::size_t>(samples.dims[2]),
      [&](std::size_t k) {
        const std::span value = std::span(samples.value).subspan(k * plane, plane);
        float largest = 0;
        for (const float v : value) largest = std::max(largest, std::abs(v));
        const float smallest = kSmallestSample * largest;
        for (float& v : value)
          if (std::abs(v) < smallest) v = v > 0 ? smallest : -smallest;
      },
      1);
}

}  // namespace kappaflow
