// The nearest of many triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/nearest_on_triangle.h"
#include "core/types.h"

namespace kappaflow {

/// A tree of bounding boxes over triangles, halved at the median along the longest side of their box.
class TriangleTree {
 public:
  using Corners = std::array<Vec3, 3>;

  struct Nearest {
    std::uint32_t triangle;  ///< in the order in which they were given
    NearestOnTriangle at;
    double square;  ///< of the distance [m2]
  };

  /// triangles: at least one, all finite [m].
  explicit TriangleTree(std::span<const Corners> triangles);

  /// The nearest triangle to x; the first of them in the order of the tree, which depends on the triangles
  /// alone, if several are as near. May be called from many threads.
  Nearest nearest(const Vec3& x) const;

  /// Calls visit(number) for every triangle whose box meets the one from lower to upper, and for others near.
  /// May be called from many threads.
  template <class Visit>
  void visit_near(const Vec3& lower, const Vec3& upper, const Visit& visit) const;

 private:
  struct Leaf {
    Corners corner;
    std::uint32_t number;
  };
  struct Node {
    Vec3 lower, upper;
    std::uint32_t begin, end;  // leaves
    std::uint32_t second;      // the second child; the first follows its parent; 0: a leaf

    double squared_distance(const Vec3& x) const {
      return (lower - x).cwiseMax(x - upper).cwiseMax(0).squaredNorm();
    }
  };

  static constexpr std::size_t kMaxDepth = 64;  // the median split halves the triangles, so 2^64 would fit

  void build(std::uint32_t begin, std::uint32_t end);
  void split(std::uint32_t begin, std::uint32_t end, const Node& node);

  std::vector<Leaf> leaves_;
  std::vector<Node> nodes_;
};

template <class Visit>
void TriangleTree::visit_near(const Vec3& lower, const Vec3& upper, const Visit& visit) const {
  std::array<std::uint32_t, kMaxDepth> stack{0};
  for (std::size_t size = 1; size > 0;) {
    const std::uint32_t index = stack[--size];
    const Node& node = nodes_[index];
    if ((node.lower.array() > upper.array()).any() || (lower.array() > node.upper.array()).any()) continue;
    if (node.second != 0) {
      stack[size++] = node.second;
      stack[size++] = index + 1;
      continue;
    }
    for (std::uint32_t f = node.begin; f < node.end; ++f) visit(leaves_[f].number);
  }
}

}  // namespace kappaflow
