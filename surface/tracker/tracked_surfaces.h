// The surface of a body of particles, followed from one instant to the next: the whole recipe, from particles
// to a mesh that is ready to be shown.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/particles.h"
#include "surface/field/particle_motion.h"
#include "surface/measure/surface_state.h"
#include "surface/tracker/fresh_surface.h"
#include "surface/tracker/particle_origins.h"
#include "surface/tracker/surface_methods.h"
#include "surface/tracker/surface_tracker.h"

namespace kappaflow {

/// How the surface of particles is defined, meshed and tracked. The defaults suit liquids.
struct SurfaceOptions {
  double sigma = 2;  ///< support radius of Eq. 12 in particle spacings
  std::optional<double>
      spacing{};  ///< of the particles [m]; empty: measured, particle_spacing() of the first
  /// T of Eq. 12; empty: half the median of the field at the first particles.
  std::optional<double> threshold{};
  WeightRule weights = WeightRule::uniform;
  double edge_length = 0.5;  ///< of the mesh where it is flat, in units of sigma
  bool remesh = true;        ///< whether the mesh's connectivity follows the surface
  bool topology = true;      ///< and whether its topology does
  /// Whether velocities are unknown, all zero, and ids pair no particle with itself at another instant.
  bool is_cloud = false;
  /// The fast particles move by this at most in one step, in units of sigma; infinite: the caller's instants
  /// are the steps.
  double motion_per_step = 0.5;
  /// One surface for each, all from the same first mesh: moved by a velocity or meshed anew in every frame;
  /// empty: evaluate_material, or evaluate_regional for a point cloud.
  std::vector<SurfaceMethod> velocities{};
  Anchor anchor = Anchor::none;  ///< of the surfaces that move by a velocity
  TrackerOptions tracker{};  ///< method, remeshing.edge_length and topology.follows_field follow from above
  std::string name = "the particles";  ///< how errors begin
};

/// The field that options ask for. first, scale: the particles that what is not given is taken from. Throws
/// InvalidInput as particle_spacing() and half_median_threshold() do.
ParticleFieldOptions field_options(const SurfaceOptions& options, std::span<const Vec3> first,
                                   std::span<const double> scale = {});

/// The speed that all but a few particles stay below [m/s]: what limits the length of a step.
double fast_speed(const Particles& particles);

/// Follows the surface of particles through time, by one method or by several side by side. All surfaces
/// start from one mesh and see the same fields, so that differences between them are the methods' own;
/// `surface` counts them from 0.
///
/// After an exception of step(), advance() or settle() the surfaces can only be destroyed or assigned to.
class TrackedSurfaces {
 public:
  /// Meshes the surface of the first particles. Throws InvalidInput when particles or options are not sound,
  /// the surface is empty, or a point cloud's textures are to come from its particles.
  explicit TrackedSurfaces(Particles first, const SurfaceOptions& options = {});
  /// The same, where the next particles are known already. The mesh does not depend on them, but the field's
  /// rates do: without them a point cloud is at rest in the first frame.
  TrackedSurfaces(Particles first, const Particles& next, const SurfaceOptions& options = {});

  /// Called after each step with its motion, for what else is to move with the fields; returns whether to go
  /// on.
  using Watch = std::function<bool(FieldMotion& step)>;

  /// Moves the surfaces to the next particles, paired with the last ones by id, in as many steps as
  /// steps_to() says. Returns false when `watch` stopped it before the last of them; the surfaces have then
  /// reached an instant in between and can go no further. Throws InvalidInput when `next` is not sound or not
  /// later, and what the velocity methods throw.
  bool step(Particles next, const Watch& watch = {});
  /// Makes the surfaces ready to be shown, see SurfaceTracker::settle(), FreshSurface and find_sources():
  /// before every frame.
  void settle(std::span<const int> source = {}, bool anew = false);
  /// step() and settle(): from frame to frame.
  void advance(Particles next, std::span<const int> source = {});

  /// In how many steps step() goes to the next particles. Throws InvalidInput where they would never end.
  int steps_to(const Particles& next) const;

  double time() const { return particles_.time; }            ///< [s]
  const Particles& particles() const { return particles_; }  ///< at that time
  const Field& field() const { return *field_; }             ///< at that time
  const ParticleFieldOptions& field_options() const { return field_options_; }
  std::size_t count() const { return surfaces_.size(); }  ///< of surfaces
  const TriangleMesh& mesh(std::size_t surface = 0) const;
  /// Normals, curvatures, velocities of one surface at its vertices.
  SurfaceState state(std::size_t surface = 0) const;

  /// Gives every vertex of unknown source, or `anew` every vertex, that of the nearest particle. One entry a
  /// particle; source may be empty, and then nothing is known. Surfaces that have their textures from the
  /// particles get both rest positions and sources from an OriginMap; of those that are anchored to them it
  /// corrects the rest positions.
  void find_sources(std::span<const int> source, bool anew = false);

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
    archive(particles_, origins_);
    for (Surface& surface : surfaces_) std::visit([&](auto& followed) { archive(followed); }, surface);
    if constexpr (Archive::is_loading::value) {
      field_ = nullptr;
      report_.assign(report_.size(), {});  // how long this run's first mesh took is not in it
    }
    archive(report_);
  }

 private:
  using Surface = std::variant<SurfaceTracker, FreshSurface>;

  TrackedSurfaces(Particles first, const Particles* next, const SurfaceOptions& options);

  static TriangleMesh& mesh_of(Surface& surface);
  static std::vector<Surface> make_surfaces(const Field& field, double sigma, const SurfaceOptions& options,
                                            TrackerStep& first_mesh);

  double cloud_speed_to(const Particles& next) const;
  ParticleMotion motion_to(const Particles& next) const;
  void step_surfaces(FieldMotion& motion);
  void take_origins(std::span<const int> source);

  Particles particles_;
  ParticleFieldOptions field_options_;
  bool is_cloud_;
  double motion_per_step_;
  std::string name_;
  std::shared_ptr<const Field> field_;
  std::vector<TrackerStep> report_;
  std::vector<Surface> surfaces_;
  std::vector<char> from_particles_;        // 1 for surfaces whose textures the particles give, or correct
  std::optional<ParticleOrigins> origins_;  // where there are such surfaces
  double first_mesh_seconds_;
};

}  // namespace kappaflow
