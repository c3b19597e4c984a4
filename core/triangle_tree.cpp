#include "core/triangle_tree.h"

#include <algorithm>

namespace kappaflow {
namespace {

constexpr int kLeafTriangles = 4;

}  // namespace

TriangleTree::TriangleTree(std::span<const Corners> triangles) {
  leaves_.reserve(triangles.size());
  for (const Corners& corner : triangles)
    leaves_.push_back({corner, static_cast<std::uint32_t>(leaves_.size())});
  build(0, static_cast<std::uint32_t>(leaves_.size()));
}

void TriangleTree::build(std::uint32_t begin, std::uint32_t end) {
  const std::size_t index = nodes_.size();
  Node node{Vec3::Constant(kInfinity), Vec3::Constant(-kInfinity), begin, end, 0};
  for (std::uint32_t t = begin; t < end; ++t)
    for (const Vec3& corner : leaves_[t].corner) {
      node.lower = node.lower.cwiseMin(corner);
      node.upper = node.upper.cwiseMax(corner);
    }
  nodes_.push_back(node);
  if (end - begin <= kLeafTriangles) return;
  split(begin, end, node);
  const std::uint32_t middle = begin + (end - begin) / 2;
  build(begin, middle);
  nodes_[index].second = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end);
}

void TriangleTree::split(std::uint32_t begin, std::uint32_t end, const Node& node) {
  Eigen::Index axis = 0;
  (node.upper - node.lower).maxCoeff(&axis);
  const auto center = [axis](const Leaf& t) {
    return t.corner[0][axis] + t.corner[1][axis] + t.corner[2][axis];
  };
  std::nth_element(leaves_.begin() + begin, leaves_.begin() + begin + (end - begin) / 2,
                   leaves_.begin() + end,
                   [&](const Leaf& a, const Leaf& b) { return center(a) < center(b); });
}

TriangleTree::Nearest TriangleTree::nearest(const Vec3& x) const {
  Nearest best{0, {}, kInfinity};
  std::array<std::uint32_t, kMaxDepth> stack{0};
  for (std::size_t size = 1; size > 0;) {
    const std::uint32_t index = stack[--size];
    const Node& node = nodes_[index];
    if (node.squared_distance(x) > best.square) continue;
    if (node.second != 0) {  // the nearer child comes off the stack first
      const bool swap = nodes_[node.second].squared_distance(x) < nodes_[index + 1].squared_distance(x);
      stack[size++] = swap ? index + 1 : node.second;
      stack[size++] = swap ? node.second : index + 1;
      continue;
    }
    for (std::uint32_t f = node.begin; f < node.end; ++f) {
      const NearestOnTriangle at = nearest_on_triangle(leaves_[f].corner, x);
      if (const double square = (x - at.point).squaredNorm(); square < best.square)
        best = {leaves_[f].number, at, square};
    }
  }
  return best;
}

}  // namespace kappaflow
