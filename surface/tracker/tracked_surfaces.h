// The surface of a body of particles, followed from one instant to the next: the whole recipe, from particles
// to a mesh that is ready to be shown.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/particles.h"
#include "surface/field/particle_motion.h"
#include "surface/tracker/surface_group.h"

namespace kappaflow {

/// The field that options ask for. first, scale: the particles that what is not given is taken from. Throws
/// InvalidInput as particle_spacing() and half_median_threshold() do.
ParticleFieldOptions field_options(const SurfaceOptions& options, std::span<const Vec3> first,
                                   std::span<const double> scale = {});

/// The speed that a share kShareOfFast of particles stay below [m/s]: what limits the length of a step.
double fast_speed(const Particles& particles);

/// Follows the surface of particles through time, by one method or by several side by side.
///
/// After an exception of step(), advance() or settle() the surfaces can only be destroyed or assigned to.
class TrackedSurfaces : public SurfaceGroup {
 public:
  /// Meshes the surface of the first particles. Throws InvalidInput when particles or options are not sound,
  /// the surface is empty, or a point cloud's textures are to come from its particles.
  explicit TrackedSurfaces(Particles first, const SurfaceOptions& options = {});
  /// The same, where the next particles are known already. The mesh does not depend on them, but the field's
  /// rates do: without them a point cloud is at rest in the first frame.
  TrackedSurfaces(Particles first, const Particles& next, const SurfaceOptions& options = {});

  /// Moves the surfaces to the next particles, paired with the last ones by id, in as many steps as
  /// steps_to() says for them and the speed. Returns false when `watch` stopped it before the last of them;
  /// the surfaces have then reached an instant in between and can go no further. Throws InvalidInput when
  /// `next` is not sound or not later, and what the velocity methods throw.
  bool step(Particles next, const Watch& watch = {}, double speed = 0);
  /// Makes the surfaces ready to be shown, see SurfaceTracker::settle(), FreshSurface and find_sources():
  /// before every frame.
  void settle(std::span<const int> source = {}, bool anew = false);
  /// step() and settle(): from frame to frame.
  void advance(Particles next, std::span<const int> source = {});

  /// From here on follows these particles in place of those at the same instant: others of the same liquid,
  /// whose field is the same near the surface. Throws InvalidInput where they are of another instant.
  void go_on_with(Particles particles);

  /// In how many steps step() goes to the next particles. speed: fast_speed() of now's and the next ones'
  /// where not all of the liquid's are among these [m/s]; 0: that of these. Throws InvalidInput where they
  /// would never end.
  int steps_to(const Particles& next, double speed = 0) const;

  double time() const { return particles_.time; }            ///< [s]
  const Particles& particles() const { return particles_; }  ///< at that time
  const ParticleFieldOptions& field_options() const { return field_options_; }

  /// Gives every vertex of unknown source, or `anew` every vertex, that of the nearest particle. One entry a
  /// particle; source may be empty, and then nothing is known. Surfaces that have their textures from the
  /// particles get both rest positions and sources from an OriginMap; of those that are anchored to them it
  /// corrects the rest positions.
  void find_sources(std::span<const int> source, bool anew = false);

  /// See SurfaceGroup.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(particles_, origins_);
    shapes_ = nullptr;  // follow from the particles
    SurfaceGroup::serialize(archive);
  }

 private:
  /// What follows from the options and the first particles: the field that the surfaces start from.
  struct Start {
    ParticleFieldOptions options;
    std::shared_ptr<const Field> field;
  };

  static Start start_of(const Particles& first, const Particles* next, const SurfaceOptions& options);
  TrackedSurfaces(Particles&& first, Start start, const SurfaceOptions& options);

  double cloud_speed_to(const Particles& next) const;
  ParticleMotion motion_to(const Particles& next) const;
  void take_origins(std::span<const int> source);

  Particles particles_;
  std::shared_ptr<const KernelShapes> shapes_;  // of these particles, where they are known already
  ParticleFieldOptions field_options_;
  bool is_cloud_;
  double motion_per_step_;
  std::string name_;
  std::vector<char> from_particles_;        // 1 for surfaces whose textures the particles give, or correct
  std::optional<ParticleOrigins> origins_;  // where there are such surfaces
};

}  // namespace kappaflow
