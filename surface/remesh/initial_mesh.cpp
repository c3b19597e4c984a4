#include "surface/remesh/initial_mesh.h"

#include "core/parallel.h"
#include "surface/mesh/isosurface.h"
#include "surface/remesh/edit_criteria.h"
#include "surface/topology/disagreement.h"

namespace kappaflow {
namespace {

constexpr int kRounds = 4;           // of remeshing and smoothing; after them few edges are edited
constexpr int kSmoothingPasses = 5;  // in each round

/// The vertices of a mesh, put on the surface.
struct OnSurface {
  std::vector<Vec3> position, gradient;
  std::vector<char> unprojected;
};

/// Half of the way to the neighbours' centroid, in the tangent plane.
Vec3 smoothed(const TriangleMesh& mesh, const VertexRings& rings, int v) {
  const std::span<const int> ring = rings.of(v);
  Vec3 sum = Vec3::Zero();
  for (const int neighbour : ring) sum += mesh.position[neighbour] - mesh.position[v];
  const Vec3 move = 0.5 / static_cast<double>(ring.size()) * sum, normal = mesh.gradient[v].normalized();
  return mesh.position[v] + move - move.dot(normal) * normal;
}

double facing_field(std::span<const Vec3> position, std::span<const Vec3> gradient,
                    const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return facing(position[a], position[b], position[c], sum_of_normals(gradient, triangle));
}

/// Puts the corners of triangles back that would face worse along the field's normals than before and than is
/// always good. Ends, for a triangle of which no corner has moved is as it was.
void put_back_what_turns(const TriangleMesh& mesh, OnSurface& moved) {
  std::vector<char> turns(mesh.triangles.size());
  do {
    parallel_for(turns.size(), [&](std::size_t t) {
      const Triangle& triangle = mesh.triangles[t];
      const double before = facing_field(mesh.position, mesh.gradient, triangle);
      turns[t] = facing_field(moved.position, moved.gradient, triangle) < std::min(WorstOf::kFacing, before);
    });
    for (std::size_t t = 0; t < turns.size(); ++t) {
      if (!turns[t]) continue;
      for (const int v : mesh.triangles[t]) {
        moved.position[v] = mesh.position[v];
        moved.gradient[v] = mesh.gradient[v];
        moved.unprojected[v] = mesh.unprojected[v];
      }
    }
  } while (std::ranges::count(turns, 1) > 0);
}

void smooth(const Field& field, const ProjectionOptions& projection, int passes, TriangleMesh& mesh) {
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  const std::size_t n = mesh.vertex_count();
  OnSurface moved{std::vector<Vec3>(n), std::vector<Vec3>(n), std::vector<char>(n)};
  for (int pass = 0; pass < passes; ++pass) {
    parallel_for(n, [&](std::size_t v) { moved.position[v] = smoothed(mesh, rings, static_cast<int>(v)); });
    project_all(field, projection, moved.position, moved.unprojected, moved.gradient);
    put_back_what_turns(mesh, moved);
    std::swap(mesh.position, moved.position);
    std::swap(mesh.gradient, moved.gradient);
    std::swap(mesh.unprojected, moved.unprojected);
  }
}

}  // namespace

TriangleMesh initial_mesh(const Field& field, double spacing, const ProjectionOptions& projection) {
  TriangleMesh mesh = extract_isosurface(field, spacing);
  project_all(field, projection, mesh.position, mesh.unprojected, mesh.gradient);
  smooth(field, projection, 1, mesh);
  const RemeshOptions even{.edge_length = spacing, .finest = 1};
  Remesher remesher;
  for (int round = 0; round < kRounds; ++round) {
    remesher.remesh(field, even, projection, vertex_rings(mesh.vertex_count(), mesh.triangles), mesh);
    smooth(field, projection, kSmoothingPasses, mesh);
  }
  TriangleMesh at_rest = make_triangle_mesh(std::move(mesh.position), std::move(mesh.triangles));
  at_rest.unprojected = std::move(mesh.unprojected);
  return at_rest;
}

}  // namespace kappaflow
