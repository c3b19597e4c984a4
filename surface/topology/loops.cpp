#include "surface/topology/loops.h"

#include <algorithm>
#include <utility>

#include "core/triangle_geometry.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/topology/disagreement.h"

namespace kappaflow {
namespace {

constexpr double kFacingWeight = 4;  // [1] a triangle that faces sideways costs five times its size

struct Cost {
  std::span<const Vec3> position, gradient;
  double operator()(int a, int b, int c) const {
    const Vec3 &x = position[a], &y = position[b], &z = position[c];
    const Vec3 normals = sum_of_normals(gradient, {a, b, c});
    return longest_edge_squared(x, y, z) * (1 + kFacingWeight * (1 - facing(x, y, z, normals)));
  }
};

/// The loop turned so that it begins with its i-th vertex, which comes again at the end.
std::vector<int> turned(std::span<const int> loop, std::size_t i) {
  std::vector<int> result(loop.begin() + static_cast<std::ptrdiff_t>(i), loop.end());
  result.insert(result.end(), loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  return result;
}

std::pair<std::size_t, std::size_t> nearest_pair(std::span<const Vec3> position, std::span<const int> from,
                                                 std::span<const int> to) {
  std::pair<std::size_t, std::size_t> best{0, 0};
  double least = kInfinity;
  for (std::size_t i = 0; i < from.size(); ++i)
    for (std::size_t j = 0; j < to.size(); ++j)
      if (const double d = (position[from[i]] - position[to[j]]).squaredNorm(); d < least) {
        least = d;
        best = {i, j};
      }
  return best;
}

}  // namespace

std::vector<Triangle> strip_between(std::span<const Vec3> position, std::span<const Vec3> gradient,
                                    std::span<const int> from, std::span<const int> to) {
  const Cost cost{position, gradient};
  const auto [start_a, start_b] = nearest_pair(position, from, to);
  const std::vector<int> a = turned(from, start_a), b = turned(to, start_b);
  // best[i][j]: cost of the strip up to the edge between a[i] and b[j].
  const std::size_t columns = b.size();
  std::vector<double> best(a.size() * columns, kInfinity);
  std::vector<char> along_a(best.size(), 0);
  best[0] = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < columns; ++j) {
      double& here = best[i * columns + j];
      if (j > 0) here = best[i * columns + j - 1] + cost(b[j], b[j - 1], a[i]);
      if (i == 0) continue;
      const double other = best[(i - 1) * columns + j] + cost(a[i - 1], a[i], b[j]);
      along_a[i * columns + j] = other < here || j == 0;
      if (along_a[i * columns + j]) here = other;
    }
  std::vector<Triangle> strip;
  for (std::size_t i = a.size() - 1, j = columns - 1; i > 0 || j > 0;) {
    if (along_a[i * columns + j]) {
      strip.push_back({a[i - 1], a[i], b[j]});
      --i;
    } else {
      strip.push_back({b[j], b[j - 1], a[i]});
      --j;
    }
  }
  return strip;
}

std::vector<Triangle> fill_loop(std::span<const Vec3> position, std::span<const Vec3> gradient,
                                std::span<const int> loop) {
  const Cost cost{position, gradient};
  const std::size_t n = loop.size();
  std::vector<double> best(n * n, 0);  // of the corners i to j
  std::vector<std::size_t> apex(n * n, 0);
  for (std::size_t length = 2; length < n; ++length)
    for (std::size_t i = 0; i + length < n; ++i) {
      const std::size_t j = i + length;
      double least = kInfinity;
      for (std::size_t k = i + 1; k < j; ++k) {
        const double c = best[i * n + k] + best[k * n + j] + cost(loop[i], loop[k], loop[j]);
        if (!(c < least)) continue;
        least = c;
        apex[i * n + j] = k;
      }
      best[i * n + j] = least;
    }
  std::vector<Triangle> triangles;
  std::vector<std::pair<std::size_t, std::size_t>> pending{{0, n - 1}};
  while (!pending.empty()) {
    const auto [i, j] = pending.back();
    pending.pop_back();
    if (j < i + 2) continue;
    const std::size_t k = apex[i * n + j];
    triangles.push_back({loop[i], loop[k], loop[j]});
    pending.emplace_back(i, k);
    pending.emplace_back(k, j);
  }
  return triangles;
}

}  // namespace kappaflow
