#include "surface/tracker/surface_group.h"

#include <fmt/format.h>

#include <utility>

#include "core/errors.h"
#include "core/stopwatch.h"
#include "surface/field/particle_motion.h"
#include "surface/motion/material.h"
#include "surface/motion/regional.h"
#include "surface/remesh/initial_mesh.h"

namespace kappaflow {
namespace {

/// What a surface moves with, as far as its field tells, where no method says it.
VelocityFunction default_velocity(const SurfaceOptions& options) {
  return options.is_cloud ? evaluate_regional : evaluate_material;
}

}  // namespace

std::vector<SurfaceMethod> methods_of(const SurfaceOptions& options) {
  if (!options.velocities.empty()) return options.velocities;
  return {default_velocity(options)};
}

SurfaceGroup::SurfaceGroup(std::shared_ptr<const Field> first, double length_scale,
                           const SurfaceOptions& options)
    : report_(methods_of(options).size()),
      surfaces_(make_surfaces(*first, length_scale, options, report_[0])),
      field_(std::move(first)),
      length_scale_(length_scale),
      first_mesh_seconds_(report_[0].topology_seconds + report_[0].remesh_seconds) {}

/// first_mesh: what making it took.
std::vector<SurfaceGroup::Surface> SurfaceGroup::make_surfaces(const Field& field, double length_scale,
                                                               const SurfaceOptions& surface,
                                                               TrackerStep& first_mesh) {
  const double edge_length = surface.edge_length * length_scale;
  TriangleMesh mesh;
  const double seconds =
      seconds_of([&] { mesh = initial_mesh(field, edge_length, surface.tracker.projection); });
  if (mesh.triangles.empty())
    throw InvalidInput(fmt::format("{}: the surface is empty: the field stays below its threshold everywhere",
                                   surface.name));
  TrackerOptions options = surface.tracker;
  options.remeshing.edge_length = surface.remesh ? edge_length : 0;
  options.topology.follows_field = surface.topology;
  TrackerStep settling;
  mesh = SurfaceTracker::settled(field, std::move(mesh), options, &settling);
  first_mesh.topology_seconds = settling.topology_seconds;
  first_mesh.remesh_seconds = seconds + settling.remesh_seconds;
  std::vector<Surface> surfaces;
  for (const SurfaceMethod& method : methods_of(surface)) {
    if (const auto* velocity = std::get_if<VelocityFunction>(&method)) {
      options.method = *velocity;
      surfaces.emplace_back(SurfaceTracker(mesh, options));
    } else {
      const bool has_grid = std::get<FreshMesh>(method) == FreshMesh::grid;
      if (has_grid && surface.is_cloud)
        throw InvalidInput(
            fmt::format("{}: textures on a grid take particles with velocities", surface.name));
      surfaces.emplace_back(
          FreshSurface(mesh, edge_length, default_velocity(surface), options.velocity,
                       has_grid ? std::optional(RestGrid(field, edge_length)) : std::nullopt));
    }
  }
  return surfaces;
}

bool SurfaceGroup::step_through(FieldMotion& motion, int steps, const Watch& watch) {
  const double t0 = motion.t0(), dt = (motion.t1() - t0) / steps;
  double time = t0;
  for (int s = 1; s <= steps; ++s) {
    const double end = s == steps ? motion.t1() : t0 + s * dt;
    MotionPart part(motion, time, end);
    for (std::size_t m = 0; m < surfaces_.size(); ++m)
      report_[m] += std::visit([&](auto& surface) { return surface.step(part); }, surfaces_[m]);
    field_ = part.at(end);
    if (watch && !watch(part) && s < steps) return false;
    motion.forget_before(end);
    time = end;
  }
  return true;
}

void SurfaceGroup::settle_surfaces() {
  for (std::size_t m = 0; m < surfaces_.size(); ++m)
    report_[m] += std::visit([&](auto& surface) { return surface.settle(*field_); }, surfaces_[m]);
}

TriangleMesh& SurfaceGroup::mesh_of(Surface& surface) {
  return std::visit([](auto& followed) -> TriangleMesh& { return followed.mesh(); }, surface);
}

const TriangleMesh& SurfaceGroup::mesh(std::size_t surface) const {
  return std::visit([](const auto& followed) -> const TriangleMesh& { return followed.mesh(); },
                    surfaces_[surface]);
}

SurfaceState SurfaceGroup::state(std::size_t surface) const {
  return std::visit([&](const auto& followed) { return followed.state(*field_); }, surfaces_[surface]);
}

std::vector<TrackerStep> SurfaceGroup::take_report() {
  return std::exchange(report_, std::vector<TrackerStep>(surfaces_.size()));
}

FieldSurfaces::FieldSurfaces(const std::shared_ptr<const Field>& first, const SurfaceOptions& options)
    : SurfaceGroup(first, first->length_scale(), options) {
  bool from_particles = options.anchor == Anchor::particles;
  for (const SurfaceMethod& method : methods_of(options))
    if (const auto* fresh = std::get_if<FreshMesh>(&method))
      from_particles = from_particles || *fresh == FreshMesh::particles;
  if (from_particles)
    throw InvalidInput(
        fmt::format("{}: textures from particles take particles; there are none", options.name));
}

}  // namespace kappaflow
