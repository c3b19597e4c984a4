// The field of Eq. 12 with kernels that follow the liquid: f(x, t) = sum_i w_i (1 - (x - c_i) . M_i (x -
// c_i))^3 - T.
#pragma once

#include <memory>
#include <span>

#include "core/cell_grid.h"
#include "surface/field/field_kernels.h"
#include "surface/field/particle_field.h"

namespace kappaflow {

struct KernelHits;

/// A sum of ellipsoids at one instant, with its analytic jet. The third derivatives jump where a kernel's
/// support ends; all else is continuous. Every sum runs in a fixed order, so results do not depend on the
/// threads.
///
/// The surface is smooth where that of the particles is not, and so it tells little of how it moves along
/// itself. The round kernels of the same particles still do: they are this field's pattern().
class AnisotropicField final : public Field {
 public:
  /// kernels: one for each of the particles. threshold: T [-]. Throws InvalidInput as ParticleField does,
  /// when the counts differ, and for shapes that are not positive definite.
  AnisotropicField(const FieldParticles& particles, const FieldKernels& kernels, double threshold,
                   double time);

  double time() const override { return pattern_.time(); }
  using Field::jet;
  Jet jet(const Vec3& x) const override;
  Jet first_order_jet(const Vec3& x) const override;
  ValueAndGradient value_and_gradient(const Vec3& x) const override;
  Bounds bounds() const override { return bounds_; }
  double length_scale() const override { return smallest_sigma_; }  ///< that of round kernels
  double fastest_speed() const override { return fastest_speed_; }
  /// That of the pattern; where only flat kernels reach, the mean of their particles' with the weights w phi.
  std::optional<Vec3> material_velocity(const Vec3& x) const override;
  const Field& pattern() const override { return pattern_; }
  std::optional<std::vector<std::array<int, 3>>> occupied_cubes(const SampledField& lattice,
                                                                int cells) const override;
  /// Scatters the kernels over the lattice, see field_slab.h.
  void sample(SampledField& samples) const override;

 private:
  /// What a kernel adds to the jet beside its place and shape.
  struct Source {
    Vec3 velocity;
    SymmetricMatrix shape_rate;
    double weight_rate, sigma;
    Vec3 material;  // the particle's velocity [m/s]
    Vec3 extent;    // of the box about the support, from its middle [m]
  };

  void set_kernels(const FieldParticles& particles, const FieldKernels& kernels,
                   std::span<const Vec3> extent);
  Vec3 center(std::size_t k) const { return {center_[0][k], center_[1][k], center_[2][k]}; }
  bool may_have_surface(std::size_t k) const;
  template <class Consume>
  void visit_hits(const Vec3& x, const Consume& consume) const;
  template <class Sums>
  Jet jet_by(const Vec3& x) const;
  void load_hits(const Vec3& x, std::span<const std::uint32_t> indices, KernelHits& hits) const;

  ParticleField pattern_;
  double threshold_, cloud_speed_;
  double smallest_sigma_ = 0, fastest_speed_ = 0;
  double reach_ = 0;  // half the longest edge of a support's box [m]
  CellGrid grid_;
  // All in the grid's cell order. value_and_gradient() reads the first three only, which are longer by lanes.
  std::array<std::vector<double>, 3> center_;
  std::array<std::vector<double>, 6> shape_;
  std::vector<double> weight_;
  std::vector<Source> source_;
  Bounds bounds_;
};

}  // namespace kappaflow
