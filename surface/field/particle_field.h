// The field of Eq. 12: f(x,t) = sum_i w_i (1 - |x - x_i|^2/sigma^2)^3 - T over particles within sigma.
#pragma once

#include <memory>
#include <span>

#include "core/cell_grid.h"
#include "core/particles.h"
#include "surface/field/field.h"

namespace kappaflow {

struct ParticleHits;
struct MaterialSums;

/// Particles with everything Eq. 12 needs, at one instant; one entry a particle in every array.
struct FieldParticles {
  std::vector<Vec3> position;       ///< x_i [m]
  std::vector<Vec3> velocity;       ///< v_i [m/s]
  std::vector<double> sigma;        ///< support radius [m], > 0
  std::vector<double> weight;       ///< w_i [-]
  std::vector<double> weight_rate;  ///< dw_i/dt [1/s]
  /// Where no velocity is known (all are zero) and the field changes through its weights alone: how fast its
  /// surface may be [m/s]. 0: velocities are known.
  double cloud_speed = 0;
};

/// Throws InvalidInput when arrays differ in length, a sigma is not positive or a number is not finite.
void check_field_particles(const FieldParticles& particles);

/// Eq. 12 at one instant, with its analytic jet; without the particles that without_strays() leaves out. The
/// third derivatives jump where a particle's support ends; all else is continuous. Every sum runs in a fixed
/// order, so results do not depend on the threads.
class ParticleField final : public Field {
 public:
  /// threshold: T [-]. Throws as check_field_particles() does.
  ParticleField(const FieldParticles& particles, double threshold, double time);

  double time() const override { return time_; }
  double threshold() const { return threshold_; }
  Jet jet(const Vec3& x) const override;
  /// The response is exact for particles whose velocities are an affine function of their position and whose
  /// weights do not depend on it.
  Jet jet(const Vec3& x, StrainResponse& strain) const override;
  Jet first_order_jet(const Vec3& x) const override;
  ValueAndGradient value_and_gradient(const Vec3& x) const override;
  Bounds bounds() const override { return bounds_; }
  double length_scale() const override { return smallest_sigma_; }  ///< 0 without particles
  double fastest_speed() const override { return fastest_speed_; }
  /// Affine moving least squares of the particles' velocities, kernel (1 - r^2)^3, basis (1, (x_i -
  /// x)/sigma), with a ridge of 0.001 times the sum of the kernel on the three gradient terms. nullopt where
  /// nothing is in reach, and everywhere where no velocity is known.
  std::optional<Vec3> material_velocity(const Vec3& x) const override;
  MovingPoint moving_point(const Vec3& x) const override;
  std::optional<std::vector<std::array<int, 3>>> occupied_cubes(const SampledField& lattice,
                                                                int cells) const override;
  /// Scatters the particles over the lattice, see field_slab.h.
  void sample(SampledField& samples) const override;

 private:
  /// What a particle adds to the jet beside its place.
  struct Source {
    Vec3 velocity;
    double sigma, weight_rate;
  };

  /// Of those particles of which `kept` has the indices.
  ParticleField(const FieldParticles& particles, std::span<const std::uint32_t> kept, double threshold,
                double time);
  void set_particles(const FieldParticles& particles, std::span<const std::uint32_t> kept);
  void sort_by_cell(const FieldParticles& particles, std::span<const std::uint32_t> kept);
  /// Calls visit(field) for this one and the coarser ones.
  template <class Visit>
  void for_each_level(const Visit& visit) const {
    for (const ParticleField* level = this; level != nullptr; level = level->coarser_.get()) visit(*level);
  }
  bool may_have_surface(const ParticleField& level, std::size_t p) const;
  template <class Consume>
  void visit_hits(const Vec3& x, const Consume& consume) const;
  template <class... Sums>
  void add_all(const Vec3& x, Sums&... sums) const;
  void load_hits(const Vec3& x, std::span<const std::uint32_t> indices, ParticleHits& hits) const;
  std::optional<Vec3> material_velocity(const MaterialSums& sums) const;

  /// The particles whose sigma is twice the smallest or more: few, and cells as large as they are would make
  /// the search for the others slow.
  std::unique_ptr<const ParticleField> coarser_;
  CellGrid grid_;
  // All in the grid's cell order. value_and_gradient() reads the first five only, which are longer by lanes.
  std::vector<double> x_, y_, z_, inverse_sigma2_, weight_;
  std::vector<Source> source_;
  double threshold_;
  double time_;
  double largest_sigma_ = 0, smallest_sigma_ = 0, fastest_speed_ = 0, cloud_speed_ = 0;
  Bounds bounds_;
};

}  // namespace kappaflow
