#include "surface/mesh/edge_edits.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace kappaflow {
namespace {

constexpr Triangle kRemoved{-1, -1, -1};

int corner_of(const Triangle& triangle, int v) {
  return static_cast<int>(std::ranges::find(triangle, v) - triangle.begin());
}

int next_after(const Triangle& triangle, int v) {
  return triangle[(corner_of(triangle, v) + 1) % 3];
}

}  // namespace

EdgeEdits::EdgeEdits(std::vector<Vec3>& position, std::vector<Triangle>& triangles)
    : position_(position), triangles_(triangles), triangles_of_(position.size()) {
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t)
    for (const int v : triangles_[t]) triangles_of_[v].push_back(t);
}

int EdgeEdits::triangle_along(int u, int v) const {
  for (const int t : triangles_of_[u])
    if (next_after(triangles_[t], u) == v) return t;
  return -1;
}

std::array<int, 2> EdgeEdits::opposite(int u, int v) const {
  const int left = triangle_along(u, v), right = triangle_along(v, u);
  if (left < 0 || right < 0) return {-1, -1};
  return {next_after(triangles_[left], v), next_after(triangles_[right], u)};
}

bool EdgeEdits::are_neighbours(int u, int v) const {
  return triangle_along(u, v) >= 0;
}

int EdgeEdits::common_neighbours(int u, int v) const {
  return static_cast<int>(std::ranges::count_if(
      triangles_of_[u], [&](int t) { return are_neighbours(v, next_after(triangles_[t], u)); }));
}

Vec3 EdgeEdits::area_vector(const Triangle& t) const {
  return (position_[t[1]] - position_[t[0]]).cross(position_[t[2]] - position_[t[0]]);
}

/// Whether the triangles of v without `other` stand the move of v to target.
bool EdgeEdits::allows_move(int v, int other, const Vec3& target, double longest) const {
  return std::ranges::all_of(triangles_of_[v], [&](int t) {
    const Triangle& triangle = triangles_[t];
    const int b = next_after(triangle, v), c = next_after(triangle, b);
    if (b == other || c == other) return true;
    const Vec3 moved = (position_[b] - target).cross(position_[c] - target);
    return moved.dot(area_vector(triangle)) > 0 && (position_[b] - target).norm() <= longest &&
           (position_[c] - target).norm() <= longest;
  });
}

void EdgeEdits::detach(int triangle, int vertex) {
  std::erase(triangles_of_[vertex], triangle);
}

bool EdgeEdits::collapse(int u, int v, double longest) {
  const auto [a, b] = opposite(u, v);
  // The link condition; and the vertices opposite to the edge, which lose a triangle, need three.
  if (a < 0 || triangles_of_[a].size() <= 3 || triangles_of_[b].size() <= 3 || common_neighbours(u, v) != 2)
    return false;
  const Vec3 midpoint = 0.5 * (position_[u] + position_[v]);
  if (!allows_move(u, v, midpoint, longest) || !allows_move(v, u, midpoint, longest)) return false;

  position_[u] = midpoint;
  for (const int t : {triangle_along(u, v), triangle_along(v, u)}) {
    for (const int corner : triangles_[t]) detach(t, corner);
    triangles_[t] = kRemoved;
  }
  for (const int t : triangles_of_[v]) {
    triangles_[t][corner_of(triangles_[t], v)] = u;
    triangles_of_[u].push_back(t);
  }
  triangles_of_[v].clear();
  return true;
}

bool EdgeEdits::flip(int u, int v) {
  const auto [a, b] = opposite(u, v);
  if (a < 0 || triangles_of_[u].size() <= 3 || triangles_of_[v].size() <= 3 || are_neighbours(a, b))
    return false;
  const int left = triangle_along(u, v), right = triangle_along(v, u);
  const Triangle new_left{u, b, a}, new_right{v, a, b};
  for (const int old : {left, right})
    for (const Triangle& flipped : {new_left, new_right})
      if (!(area_vector(triangles_[old]).dot(area_vector(flipped)) > 0)) return false;

  triangles_[left] = new_left;
  triangles_[right] = new_right;
  detach(left, v);
  detach(right, u);
  triangles_of_[b].push_back(left);
  triangles_of_[a].push_back(right);
  return true;
}

void EdgeEdits::compact() {
  std::vector<int> renumbered(position_.size(), -1);
  int kept = 0;
  for (std::size_t v = 0; v < position_.size(); ++v) {
    if (triangles_of_[v].empty()) continue;
    position_[kept] = position_[v];
    renumbered[v] = kept++;
  }
  position_.resize(kept);
  std::erase(triangles_, kRemoved);
  for (Triangle& triangle : triangles_)
    for (int& v : triangle) v = renumbered[v];
}

}  // namespace kappaflow
