// Several surfaces as one.
#pragma once

#include <vector>

#include "core/types.h"

namespace kappaflow::test {

inline TriangleSurface joined(const std::vector<TriangleSurface>& pieces) {
  TriangleSurface all;
  for (const TriangleSurface& piece : pieces) {
    const int first = static_cast<int>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), piece.vertices.begin(), piece.vertices.end());
    for (const auto& [a, b, c] : piece.triangles) all.triangles.push_back({first + a, first + b, first + c});
  }
  return all;
}

}  // namespace kappaflow::test
