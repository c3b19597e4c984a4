// Isotropic remeshing after Botsch & Kobbelt, "A remeshing approach to multiresolution modeling" (2004),
// without its splits: a lattice gives no long edges.
#include "surface/tracker/initial_mesh.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/parallel.h"
#include "surface/mesh/edge_edits.h"
#include "surface/mesh/isosurface.h"

namespace kappaflow {
namespace {

constexpr double kShortEdge = 0.6, kLongEdge = 1.4;  // in spacings
constexpr int kRounds = 4, kFlipPasses = 10, kSmoothingPasses = 5;
// Opposite angles must exceed pi by about this much for a flip: without it rounding could flip back and
// forth.
constexpr double kFlipMargin = 1e-9;

/// Calls visit(u, v) for every edge that the triangles had when its turn came.
template <class Visit>
void for_each_edge(const std::vector<Triangle>& triangles, const Visit& visit) {
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int corner = 0; corner < 3; ++corner) {
      const int u = triangles[t][corner], v = triangles[t][(corner + 1) % 3];
      if (u < v) visit(u, v);
    }
}

double cotangent(const Vec3& apex, const Vec3& a, const Vec3& b) {
  return (a - apex).dot(b - apex) / (a - apex).cross(b - apex).norm();
}

void collapse_short_edges(double spacing, std::vector<Vec3>& position, std::vector<Triangle>& triangles) {
  EdgeEdits edits(position, triangles);
  for_each_edge(triangles, [&](int u, int v) {
    if ((position[u] - position[v]).norm() < kShortEdge * spacing) edits.collapse(u, v, kLongEdge * spacing);
  });
  edits.compact();
}

void flip_towards_delaunay(std::vector<Vec3>& position, std::vector<Triangle>& triangles) {
  EdgeEdits edits(position, triangles);
  bool flipped = true;
  for (int pass = 0; flipped && pass < kFlipPasses; ++pass) {
    flipped = false;
    for_each_edge(triangles, [&](int u, int v) {
      const auto [a, b] = edits.opposite(u, v);
      const double sum =
          cotangent(position[a], position[u], position[v]) + cotangent(position[b], position[u], position[v]);
      if (sum < -kFlipMargin) flipped |= edits.flip(u, v);
    });
  }
}

/// Moves every vertex half of the way to its neighbours' centroid, in its tangent plane.
void smooth(const VertexRings& rings, std::span<const Vec3> gradient, TriangleMesh& mesh,
            std::vector<Vec3>& moved) {
  moved.resize(mesh.vertex_count());
  parallel_for(mesh.vertex_count(), [&](std::size_t v) {
    Vec3 sum = Vec3::Zero();
    const std::span<const int> ring = rings.of(static_cast<int>(v));
    for (const int neighbour : ring) sum += mesh.position[neighbour] - mesh.position[v];
    const Vec3 move = 0.5 / static_cast<double>(ring.size()) * sum, normal = gradient[v].normalized();
    moved[v] = mesh.position[v] + move - move.dot(normal) * normal;
  });
  std::swap(mesh.position, moved);
}

void smooth_and_project(const Field& field, const ProjectionOptions& projection, TriangleMesh& mesh) {
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  std::vector<Vec3> gradient(mesh.vertex_count()), moved;
  mesh.unprojected.resize(mesh.vertex_count());
  project_all(field, projection, mesh.position, mesh.unprojected, gradient);
  for (int pass = 0; pass < kSmoothingPasses; ++pass) {
    smooth(rings, gradient, mesh, moved);
    project_all(field, projection, mesh.position, mesh.unprojected, gradient);
  }
}

}  // namespace

TriangleMesh initial_mesh(const Field& field, double spacing, const ProjectionOptions& projection) {
  TriangleMesh mesh = extract_isosurface(field, spacing);
  for (int round = 0; round < kRounds; ++round) {
    collapse_short_edges(spacing, mesh.position, mesh.triangles);
    flip_towards_delaunay(mesh.position, mesh.triangles);
    smooth_and_project(field, projection, mesh);
  }
  mesh.rest_position = mesh.position;
  return mesh;
}

}  // namespace kappaflow
