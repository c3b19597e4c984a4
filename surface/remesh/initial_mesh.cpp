// Isotropic remeshing after Botsch & Kobbelt, "A remeshing approach to multiresolution modeling" (2004),
// without its splits: a lattice gives no long edges.
#include "surface/remesh/initial_mesh.h"

#include <cmath>

#include "core/parallel.h"
#include "core/triangle_geometry.h"
#include "surface/mesh/isosurface.h"
#include "surface/mesh/mesh_edits.h"
#include "surface/mesh/mesh_measures.h"

namespace kappaflow {
namespace {

constexpr double kShortEdge = 0.6, kLongEdge = 1.4;  // in spacings
constexpr int kRounds = 4, kFlipPasses = 10, kSmoothingPasses = 5;

Vec3 area_vector(const TriangleMesh& mesh, int a, int b, int c) {
  return twice_area_vector(mesh.position[a], mesh.position[b], mesh.position[c]);
}

/// Whether the triangles of v without `other` stand the move of v to target: none turns by a right angle.
bool allows_move(const MeshEdits& edits, const TriangleMesh& mesh, int v, int other, const Vec3& target,
                 double longest) {
  bool allowed = true;
  edits.for_each_out(v, [&](int h) {
    const int b = edits.end(h), c = edits.apex(h);
    if (b == other || c == other) return;
    const Vec3 &at_b = mesh.position[b], &at_c = mesh.position[c];
    allowed = allowed && twice_area_vector(target, at_b, at_c).dot(area_vector(mesh, v, b, c)) > 0 &&
              (at_b - target).norm() <= longest && (at_c - target).norm() <= longest;
  });
  return allowed;
}

/// Joins the ends of short edges at their midpoints.
void collapse_short_edges(double spacing, MeshEdits& edits, TriangleMesh& mesh) {
  edits.start(mesh);
  for (int h = 0; h < edits.half_edges(); ++h) {
    if (edits.is_removed(h)) continue;
    const int u = edits.origin(h), v = edits.end(h);
    if (u > v || !((mesh.position[u] - mesh.position[v]).norm() < kShortEdge * spacing)) continue;
    const Vec3 midpoint = 0.5 * (mesh.position[u] + mesh.position[v]);
    if (!edits.can_collapse(edits.twin(h)) ||
        !allows_move(edits, mesh, u, v, midpoint, kLongEdge * spacing) ||
        !allows_move(edits, mesh, v, u, midpoint, kLongEdge * spacing))
      continue;
    edits.collapse(edits.twin(h));
    mesh.position[u] = midpoint;
  }
  edits.finish();
}

bool flips_towards_delaunay(MeshEdits& edits, const TriangleMesh& mesh, int h) {
  const int u = edits.origin(h), v = edits.end(h), a = edits.apex(h), b = edits.apex(edits.twin(h));
  const std::vector<Vec3>& at = mesh.position;
  if (is_delaunay(at[u], at[v], at[a], at[b])) return false;
  for (const Vec3& old : {area_vector(mesh, u, v, a), area_vector(mesh, v, u, b)})
    if (!(old.dot(area_vector(mesh, u, b, a)) > 0) || !(old.dot(area_vector(mesh, v, a, b)) > 0))
      return false;
  return edits.flip(h);
}

void flip_towards_delaunay(MeshEdits& edits, TriangleMesh& mesh) {
  edits.start(mesh);
  bool flipped = true;
  for (int pass = 0; flipped && pass < kFlipPasses; ++pass) {
    flipped = false;
    for (int h = 0; h < edits.half_edges(); ++h)
      if (edits.origin(h) < edits.end(h)) flipped |= flips_towards_delaunay(edits, mesh, h);
  }
  edits.finish();
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
  MeshEdits edits;
  for (int round = 0; round < kRounds; ++round) {
    collapse_short_edges(spacing, edits, mesh);
    flip_towards_delaunay(edits, mesh);
    smooth_and_project(field, projection, mesh);
  }
  TriangleMesh at_rest = make_triangle_mesh(std::move(mesh.position), std::move(mesh.triangles));
  at_rest.unprojected = std::move(mesh.unprojected);
  return at_rest;
}

}  // namespace kappaflow
