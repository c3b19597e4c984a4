#include "surface/tracker/fresh_surface.h"

#include <utility>

#include "core/parallel.h"
#include "core/stopwatch.h"
#include "surface/mesh/isosurface.h"
#include "surface/mesh/nearest_on_mesh.h"

namespace kappaflow {
namespace {

TriangleMesh placed_isosurface(const Field& field, double spacing) {
  TriangleMesh mesh = extract_isosurface(field, spacing);
  place_on_surface(field, spacing, ProjectionOptions{}.tolerance * field.length_scale(), mesh.position);
  return mesh;
}

}  // namespace

FreshSurface::FreshSurface(TriangleMesh first, double spacing, VelocityFunction velocity,
                           const VelocityOptions& options, std::optional<RestGrid> grid)
    : mesh_(std::move(first)),
      spacing_(spacing),
      velocity_(std::move(velocity)),
      velocity_options_(options),
      grid_(std::move(grid)) {}

TrackerStep FreshSurface::step(FieldMotion& motion) {
  TrackerStep report;
  if (grid_) report.texture_seconds = seconds_of([&] { grid_->step(motion); });
  return report;
}

TrackerStep FreshSurface::settle(const Field& field) {
  TrackerStep report;
  TriangleMesh fresh;
  report.topology_seconds = seconds_of([&] { fresh = placed_isosurface(field, spacing_); });
  report.texture_seconds = seconds_of([&] { take_over(std::move(fresh)); });
  return report;
}

/// Puts the fresh vertices behind the old ones, so that their arrays can be filled from these, and lets these
/// go.
void FreshSurface::take_over(TriangleMesh fresh) {
  const std::size_t old = mesh_.vertex_count(), n = fresh.vertex_count();
  std::vector<std::optional<NearestOnMesh::Point>> from(n);
  const NearestOnMesh last(mesh_);
  parallel_for(n, [&](std::size_t v) { from[v] = last.nearest(fresh.position[v]); });
  mesh_.position.insert(mesh_.position.end(), fresh.position.begin(), fresh.position.end());
  for (std::size_t v = 0; v < n; ++v) complete_vertex(mesh_, old + v, from[v] ? &from[v]->blend : nullptr);
  for (Triangle& triangle : fresh.triangles)
    for (int& v : triangle) v += static_cast<int>(old);
  mesh_.triangles = std::move(fresh.triangles);
  std::vector<char> alive(old, 0);
  alive.resize(old + n, 1);
  VertexHistory history;
  remove_dead(alive, mesh_, history);
  if (!grid_) return;
  parallel_for(n, [&](std::size_t v) {
    if (const std::optional<Vec3> rest = grid_->at(mesh_.position[v])) mesh_.rest_position[v] = *rest;
  });
}

SurfaceState FreshSurface::state(const Field& field) const {
  SurfaceState state = surface_state(field, mesh_, vertex_rings(mesh_.vertex_count(), mesh_.triangles),
                                     velocity_, velocity_options_);
  state.material_velocity.clear();
  state.material_slip.clear();
  return state;
}

}  // namespace kappaflow
