// Finds the triangles near a point.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/hashed_bins.h"
#include "core/space_cell.h"
#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {

/// Triangles by the cells of a grid that they come within `reach` of.
class TriangleBins {
 public:
  TriangleBins(const TriangleMesh& mesh, std::span<const int> triangles, double reach) : size_(8 * reach) {
    std::vector<HashedBins::Entry> entries;
    for (const int t : triangles) {
      const auto& [a, b, c] = mesh.triangles[t];
      const Vec3 &x = mesh.position[a], &y = mesh.position[b], &z = mesh.position[c];
      const SpaceCell first = space_cell(x.cwiseMin(y).cwiseMin(z).array() - reach, size_),
                      last = space_cell(x.cwiseMax(y).cwiseMax(z).array() + reach, size_);
      for (std::int64_t k = first[2]; k <= last[2]; ++k)
        for (std::int64_t j = first[1]; j <= last[1]; ++j)
          for (std::int64_t i = first[0]; i <= last[0]; ++i)
            entries.push_back({cell_key(SpaceCell{i, j, k}), t});
    }
    bins_ = HashedBins(entries);
  }

  /// Whether `test` holds for a triangle of x's cell.
  template <class Test>
  bool any_near(const Vec3& x, const Test& test) const {
    const std::uint64_t at = cell_key(space_cell(x, size_));
    return std::ranges::any_of(bins_.near(at), [&](const HashedBins::Entry& entry) {
      return entry.key == at && test(entry.number);
    });
  }

 private:
  double size_;
  HashedBins bins_;
};

}  // namespace kappaflow
