// Several surfaces side by side, from one mesh and through the same fields.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "surface/measure/surface_state.h"
#include "surface/tracker/fresh_surface.h"
#include "surface/tracker/surface_options.h"
#include "surface/tracker/surface_tracker.h"

namespace kappaflow {

/// Surfaces by one method each. All start from one mesh and see the same fields, so that differences between
/// them are the methods' own; `surface` counts them from 0. What moves them is in the derived classes:
/// TrackedSurfaces of particles, FieldSurfaces of any field.
class SurfaceGroup {
 public:
  /// Called after each step with its motion, for what else is to move with the fields; returns whether to go
  /// on.
  using Watch = std::function<bool(FieldMotion& step)>;

  const Field& field() const { return *field_; }          ///< at the instant that is reached
  double length_scale() const { return length_scale_; }   ///< by which everything is measured [m]
  std::size_t count() const { return surfaces_.size(); }  ///< of surfaces
  const TriangleMesh& mesh(std::size_t surface = 0) const;
  /// Normals, curvatures, velocities of one surface at its vertices.
  SurfaceState state(std::size_t surface = 0) const;

  /// Registers an array over the vertices of all surfaces, see TriangleMesh::add_array(): edits of the meshes
  /// carry it along, and files hold it.
  template <class T>
  void add_array(std::string_view name, Carry carry, const T& fresh) {
    for (Surface& surface : surfaces_) mesh_of(surface).add_array(name, carry, fresh);
  }
  /// Its entries, one a vertex of the surface, to be read and filled in; until the next step.
  template <class T>
  std::span<T> array(std::string_view name, std::size_t surface = 0) {
    return mesh_of(surfaces_[surface]).template array<T>(name);
  }

  /// The wall time that the first mesh took [s]; in the first report it is among that of the first surface.
  double first_mesh_seconds() const { return first_mesh_seconds_; }
  /// What happened since the last call, an entry a surface; the next one starts anew.
  std::vector<TrackerStep> take_report();

  /// See core/saved_state.h; for surfaces that were made with the same options. field() is not saved: there
  /// is none until the next step.
  template <class Archive>
  void serialize(Archive& archive) {
    for (Surface& surface : surfaces_) std::visit([&](auto& followed) { archive(followed); }, surface);
    if constexpr (Archive::is_loading::value) {
      field_ = nullptr;
      report_.assign(report_.size(), {});  // how long this run's first mesh took is not in it
    }
    archive(report_);
  }

 protected:
  using Surface = std::variant<SurfaceTracker, FreshSurface>;

  /// Meshes the surface of the first field. length_scale [m]. Throws InvalidInput when options are not sound
  /// or the surface is empty.
  SurfaceGroup(std::shared_ptr<const Field> first, double length_scale, const SurfaceOptions& options);

  /// Moves all surfaces through a motion, in so many steps. Returns false when `watch` stopped it before the
  /// last of them.
  bool step_through(FieldMotion& motion, int steps, const Watch& watch);
  /// SurfaceTracker::settle() and FreshSurface::settle() of each.
  void settle_surfaces();

  static TriangleMesh& mesh_of(Surface& surface);

  std::vector<TrackerStep> report_;
  std::vector<Surface> surfaces_;

 private:
  static std::vector<Surface> make_surfaces(const Field& field, double length_scale,
                                            const SurfaceOptions& options, TrackerStep& first_mesh);

  std::shared_ptr<const Field> field_;
  double length_scale_;
  double first_mesh_seconds_;
};

/// The methods of a group's surfaces: those that are asked for, or the one that suits what is known of the
/// motion.
std::vector<SurfaceMethod> methods_of(const SurfaceOptions& options);

/// Follows the surface of any field through time.
///
/// After an exception of step() or settle() the surfaces can only be destroyed or assigned to.
class FieldSurfaces : public SurfaceGroup {
 public:
  /// Meshes the surface of the first field. Of the options, what says how particles become a field does not
  /// count; is_cloud: whether the field knows no velocity of the material. Throws InvalidInput when options
  /// are not sound, the surface is empty, or textures are to come from particles.
  explicit FieldSurfaces(const std::shared_ptr<const Field>& first, const SurfaceOptions& options = {});

  /// Moves the surfaces from motion.t0() to motion.t1(), in so many steps: in one the surface should move by
  /// at most its length scale. Returns false when `watch` stopped it before the last of them.
  bool step(FieldMotion& motion, int steps = 1, const Watch& watch = {}) {
    return step_through(motion, steps, watch);
  }
  /// Makes the surfaces ready to be shown, see SurfaceTracker::settle() and FreshSurface: before every frame.
  void settle() { settle_surfaces(); }
};

}  // namespace kappaflow
