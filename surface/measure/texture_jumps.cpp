#include "surface/measure/texture_jumps.h"

#include <Eigen/Geometry>

#include "core/connectivity.h"
#include "core/parallel.h"

namespace kappaflow {
namespace {

/// The derivative of rest_position into a half-edge's triangle, orthogonal to the edge.
struct Side {
  Vec3 derivative;
  bool known;
};

Side side_of(const TriangleMesh& mesh, int u, int v, int apex) {
  const Vec3 edge = mesh.position[v] - mesh.position[u], to_apex = mesh.position[apex] - mesh.position[u];
  const Vec3 rest_edge = mesh.rest_position[v] - mesh.rest_position[u],
             rest_to_apex = mesh.rest_position[apex] - mesh.rest_position[u];
  const double share = to_apex.dot(edge) / edge.squaredNorm(), height = (to_apex - share * edge).norm();
  const bool known = height > 0 && edge.squaredNorm() > 0;
  return {known ? Vec3((rest_to_apex - share * rest_edge) / height) : Vec3::Zero(), known};
}

}  // namespace

TextureJumps texture_jumps(const TriangleMesh& mesh) {
  std::vector<Side> sides(3 * mesh.triangles.size());
  parallel_for(sides.size(), [&](std::size_t h) {
    const Triangle& t = mesh.triangles[h / 3];
    const std::size_t corner = h % 3;
    sides[h] = side_of(mesh, t[corner], t[(corner + 1) % 3], t[(corner + 2) % 3]);
  });
  // The derivatives of the two sides of an edge point apart.
  const EdgeSides edges(mesh.triangles);
  const Vec3 sum = parallel_sum(edges.edges(), Vec3(Vec3::Zero()), [&](std::size_t e) -> Vec3 {
    const std::span<const int> along = edges.of(e);
    if (along.size() != 2) return Vec3::Zero();
    const Side &a = sides[along[0]], &b = sides[along[1]];
    const double size = 0.5 * (a.derivative.norm() + b.derivative.norm());
    if (!a.known || !b.known || !(size > 0)) return Vec3::Zero();
    const double jump = (a.derivative + b.derivative).norm() / size;
    return {jump, jump > 1 ? 1.0 : 0.0, 1};
  });
  return sum[2] > 0 ? TextureJumps{sum[0] / sum[2], sum[1] / sum[2]} : TextureJumps{};
}

}  // namespace kappaflow
