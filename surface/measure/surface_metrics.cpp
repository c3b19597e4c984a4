#include "surface/measure/surface_metrics.h"

#include <algorithm>
#include <cmath>

#include "core/shared_loop.h"
#include "core/solid_distance.h"
#include "surface/field/projection.h"
#include "surface/mesh/isosurface.h"
#include "surface/mesh/self_intersection.h"
#include "surface/topology/winding_numbers.h"

namespace kappaflow {
namespace {

constexpr double kIsosurfaceSpacing = 0.25;                 // of the fresh extraction, in sigma
constexpr double kSmallestAngle = 15, kLargestAngle = 140;  // of a triangle in good order [degrees]

/// The largest distance between a fresh isosurface and a mesh, each way [sigma]; 0 where one is empty.
void measure_distances(const Field& field, const TriangleMesh& isosurface, const TriangleMesh& mesh,
                       SurfaceJudgement& judgement) {
  if (isosurface.triangles.empty() || mesh.triangles.empty()) return;
  const double sigma = field.length_scale();
  const SolidDistance to_mesh(TriangleSurface{mesh.position, mesh.triangles}),
      to_isosurface(TriangleSurface{isosurface.position, isosurface.triangles});
  judgement.surface_without_mesh = shared_max(
      isosurface.vertex_count(), 0.0,
      [&](std::size_t v) { return std::abs(to_mesh.nearest(isosurface.position[v]).distance) / sigma; },
      kDefaultGrain);
  // The isosurface's chords are off f = 0, and a projection may miss the nearest point or fail.
  judgement.mesh_without_surface = shared_max(
      mesh.triangles.size(), 0.0,
      [&](std::size_t t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const Vec3 centroid = (mesh.position[a] + mesh.position[b] + mesh.position[c]) / 3;
        const Projected projected = project(field, centroid, {});
        const double to_chords = std::abs(to_isosurface.nearest(centroid).distance);
        return (projected.converged ? std::min(to_chords, (projected.position - centroid).norm())
                                    : to_chords) /
               sigma;
      },
      kDefaultGrain);
}

}  // namespace

FreshIsosurface fresh_isosurface(const Field& field, double sigma) {
  TriangleMesh mesh = extract_isosurface(field, kIsosurfaceSpacing * sigma);
  const IsosurfaceMetrics metrics{area_and_volume(mesh.position, mesh.triangles).volume,
                                  mesh_topology(mesh.position, mesh.triangles)};
  place_on_surface(field, kIsosurfaceSpacing * sigma, ProjectionOptions{}.tolerance * sigma, mesh.position);
  return {std::move(mesh), metrics};
}

double surface_residual(const Field& field, const TriangleMesh& mesh) {
  const auto residual = [&](std::size_t v) {
    if (mesh.unprojected[v]) return 0.0;
    const ValueAndGradient at = field.value_and_gradient(mesh.position[v]);
    return std::abs(at.f) / (at.g.norm() * field.length_scale());
  };
  return parallel_max(mesh.vertex_count(), 0.0, residual);
}

std::size_t points_outside(const Field& field, std::span<const Vec3> points) {
  std::vector<char> outside(points.size());
  shared_for(
      points.size(), [&](std::size_t i) { outside[i] = field.value_and_gradient(points[i]).f < 0; },
      kDefaultGrain, outside);
  return static_cast<std::size_t>(std::ranges::count(outside, 1));
}

SurfaceMetrics surface_metrics(const Field& field, const TriangleMesh& mesh, const SurfaceState& state,
                               const Vec3& report_axis) {
  SurfaceMetrics metrics;
  metrics.vertices = mesh.vertex_count();
  metrics.triangles = mesh.triangles.size();
  metrics.residual_max = surface_residual(field, mesh);
  metrics.quality = triangle_qualities(mesh.position, mesh.triangles);
  metrics.size = area_and_volume(mesh.position, mesh.triangles);
  metrics.slip = slip(state);
  metrics.pieces = rotation_by_piece(mesh, state, report_axis);
  metrics.rotation_captured = largest_piece_rotation(metrics.pieces);
  metrics.topology = mesh_topology(mesh.position, mesh.triangles);
  metrics.unprojected = static_cast<std::size_t>(std::ranges::count(mesh.unprojected, char{1}));
  metrics.folded_fraction = folded_fraction(mesh.position, state.normal, mesh.triangles);
  metrics.angles_outside = angles_outside(mesh.position, mesh.triangles, kSmallestAngle, kLargestAngle);
  metrics.texture = texture_jumps(mesh);
  return metrics;
}

SurfaceJudgement judge_surface(const Field& field, const TriangleMesh& isosurface, const TriangleMesh& mesh) {
  SurfaceJudgement judgement;
  judgement.self_intersections = self_intersections(mesh.position, mesh.triangles);
  const SampledField lattice = isosurface_lattice(field, kIsosurfaceSpacing * field.length_scale());
  const TriangleMesh seen = seen_by_lattice(mesh, lattice);
  judgement.on_lattice = mesh_topology(seen.position, seen.triangles);
  measure_distances(field, isosurface, mesh, judgement);
  return judgement;
}

bool SurfaceMetrics::sound(const IsosurfaceMetrics& isosurface) const {
  return unprojected == 0 && folded_fraction <= kSoundFolded &&
         std::abs(size.volume - isosurface.volume) <= kSoundVolume * isosurface.volume &&
         topology.components == isosurface.topology.components && topology.genus == isosurface.topology.genus;
}

}  // namespace kappaflow
