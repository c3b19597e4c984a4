#include "surface/mesh/nearest_on_mesh.h"

#include <cmath>

#include "core/nearest_on_triangle.h"

namespace kappaflow {
namespace {

TriangleTree::Corners corners_in(const TriangleMesh& mesh, const Triangle& t) {
  return {mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]};
}

}  // namespace

NearestOnMesh::NearestOnMesh(const TriangleMesh& mesh) : mesh_(mesh) {
  std::vector<TriangleTree::Corners> corners;
  corners.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) corners.push_back(corners_in(mesh, t));
  if (!corners.empty()) tree_.emplace(corners);
}

std::optional<NearestOnMesh::Point> NearestOnMesh::nearest(const Vec3& x) const {
  if (!tree_) return std::nullopt;
  const TriangleTree::Nearest found = tree_->nearest(x);
  const Triangle& t = mesh_.triangles[found.triangle];
  const Vec3 weight = corner_weights(corners_in(mesh_, t), found.at.point);
  return Point{{t, {weight[0], weight[1], weight[2]}}, std::sqrt(found.square)};
}

}  // namespace kappaflow
