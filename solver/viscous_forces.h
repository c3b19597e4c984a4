// The linear map from the liquid's velocities to viscous accelerations.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "solver/boundary.h"
#include "solver/fluid_particles.h"
#include "solver/lanes.h"
#include "solver/neighbours.h"
#include "solver/options.h"

namespace kappaflow {

/// c [1/m4] of a pair of liquid particles, so that the viscous acceleration is -nu sum_j c_ij x_ij (x_ij .
/// v_ij). Any c(r) >= 0 whose fourth moment sum_j c x x x x is that of the Laplacian will do (Espanol &
/// Revenga, "Smoothed dissipative particle dynamics", 2003); the usual 2 (d + 2) V |F| / (r2 + 0.01
/// support^2) of Weiler et al. 2018, Eq. 8, makes a cubic lattice, with which liquid starts and which slow
/// flow keeps, 0.70 times as viscous as it should be in shear along its axes and 1.23 times at 45 degrees.
/// The three coefficients here make the fourth moment isotropic and right on the lattice of the spacing, and
/// right for a continuum of particles.
class ViscosityWeight {
 public:
  explicit ViscosityWeight(float support) : inverse_square_(1 / (support * support)) {}

  /// c at the squared distance r2, up to the support. T is float or Wide.
  template <class T>
  T operator()(const T& r2) const {
    return scale() * shape(r2);
  }
  /// c over scale().
  template <class T>
  [[gnu::always_inline]] T shape(const T& r2) const {
    const T s = 1.0f - r2 * inverse_square_;
    return s * (0.56891262f + s * (5.23485966f * s - 2.36495851f));
  }
  float scale() const { return 16 * inverse_square_ * inverse_square_; }

 private:
  float inverse_square_;
};

/// What (L v)_i takes from the neighbours of particle i.
class PairResistance {
 public:
  PairResistance(std::size_t i, const std::vector<Vec4f>& v) : v_(v), own_(v[i]) {}

  /// As ViscousForces::for_pairs() calls its visit.
  [[gnu::always_inline]] void add(const PairBlock& block, const WideVec& x, const Wide& weight) {
    const WideVec other = gather(v_, block);
    const Wide scale =
        weight * (x.x * (own_[0] - other.x) + x.y * (own_[1] - other.y) + x.z * (own_[2] - other.z));
    x_ += scale * x.x;
    y_ += scale * x.y;
    z_ += scale * x.z;
  }
  Vec4f sum() const { return sums(x_, y_, z_); }

 private:
  const std::vector<Vec4f>& v_;
  Vec4f own_;
  Wide x_ = Wide::Zero(), y_ = Wide::Zero(), z_ = Wide::Zero();
};

/// The viscous force is f - L v [m/s2], over the mass of a particle of fluid 0:
///   (L v)_i = sum_j nu_ij c_ij x_ij (x_ij . v_ij) + nu_i' g_i (I - n n^T) v_i,
///   f_i     = nu_i' g_i (I - n n^T) v_w,
/// with nu_ij the viscosity between two particles, nu' that at walls (g, n and v_w: see WallSums), summed
/// over the particle's contacts. Viscosities are dynamic ones, over the rest density of fluid 0 [m2/s]. L is
/// symmetric, positive semidefinite, and zero for rigid motions of free liquid.
class ViscousForces {
 public:
  explicit ViscousForces(const FluidOptions& options);

  /// Whether no fluid is viscous, or may be.
  bool none() const;
  std::size_t fluids() const { return fluids_; }
  /// Kinematic; of a fluid whose particles have viscosities of their own the largest of them [m2/s].
  float kinematic_viscosity(std::size_t fluid) const { return viscosity_[fluid] / mass_[fluid]; }

  /// Whether there are fluids that are not Newtonian, or whose viscosity depends on the temperature.
  bool vary() const { return !laws_.empty(); }
  /// Whether there are fluids that are not Newtonian.
  bool depend_on_flow() const { return depend_on_flow_; }
  /// Finds the viscosities of all particles, for their temperatures and shear rates in the flow v: nu_i from
  /// shear_rate(), nu_i' from that between the particle and the wall. again: those of `particles` are of
  /// the iterate before. Precondition: vary().
  void find_viscosities(FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                        std::vector<Vec4f>& v, bool again = false);
  /// Whether viscous forces can change the particle's velocity: it is viscous and not led.
  bool act_on(std::size_t i, const FluidParticles& particles) const {
    if (particles.led_by[i] != 0) return false;
    return wall_viscosity_[particles.fluid[i]] > 0 || viscosity_[particles.fluid[i]] > 0;
  }

  /// Calls visit(block, x, w, x_j) for the blocks of particle i's neighbours: x = x_ij [m], w = nu_ij c_ij
  /// [1/(m2 s)], 0 for padding.
  template <class Visit>
  [[gnu::always_inline]] void for_pairs(std::size_t i, const FluidParticles& particles,
                                        const NeighbourLists& lists, const Visit& visit) const;

  /// (L v)_i for one vector a particle.
  [[gnu::always_inline]] Vec4f resistance(std::size_t i, const FluidParticles& particles,
                                          const NeighbourLists& lists, const WallSums& walls,
                                          const std::vector<Vec4f>& v) const;
  /// nu_i' g_i (I - n n^T) u, the walls' part of it.
  Vec4f wall_drag(std::size_t i, const FluidParticles& particles, const WallSums& walls,
                  const Vec4f& u) const {
    if (!walls.touches(i)) return Vec4f::Zero();
    return wall_viscosity(i, particles) * walls.drag(i, u);
  }
  /// nu_i' g (I - n n^T) u of one of its contacts.
  Vec4f contact_drag(std::size_t i, std::size_t contact, const FluidParticles& particles,
                     const WallSums& walls, const Vec4f& u) const {
    return wall_viscosity(i, particles) * walls.contact_drag(contact, u);
  }
  /// f_i.
  Vec4f wall_drive(std::size_t i, const FluidParticles& particles, const WallSums& walls) const {
    if (!walls.touches(i)) return Vec4f::Zero();
    return wall_viscosity(i, particles) * walls.drive(i);
  }

 private:
  /// Of a particle of `fluid` and the eight of the block.
  Wide pair_scales(std::uint8_t fluid, const FluidParticles& particles, const PairBlock& block) const;
  /// The same of viscosities that vary.
  Wide varying_scales(float viscosity, const FluidParticles& particles, const PairBlock& block) const;
  float wall_viscosity(std::size_t i, const FluidParticles& particles) const {
    return vary() ? particles.wall_viscosity[i] : wall_viscosity_[particles.fluid[i]];
  }
  void find_viscosity(std::size_t i, FluidParticles& particles, const NeighbourLists& lists,
                      const WallSums& walls, const std::vector<Vec4f>& v, bool again) const;

  ViscosityWeight weight_;
  float spacing_, slip_;  // slip: d / (d + slip length), d the contact distance
  std::size_t fluids_;
  std::vector<float> mass_;                 // by fluid i, of a particle over that of fluid 0's
  std::vector<float> viscosity_;            // by i; where it varies the largest
  std::vector<float> reference_viscosity_;  // the same at the reference temperature
  std::vector<float> pair_viscosity_;       // by i and j: the harmonic mean
  std::vector<float> pair_scale_;           // times the weight's scale
  std::vector<float> wall_viscosity_;       // by i: the same times slip_
  struct Law {
    Rheology of_shear;
    TemperatureLaw of_temperature;
    bool varies() const { return !is_newtonian(of_shear) || has_temperature_law(of_temperature); }
  };
  std::vector<Law> laws_;  // by fluid; empty if none varies
  bool depend_on_flow_ = false;
};

inline Wide ViscousForces::pair_scales(std::uint8_t fluid, const FluidParticles& particles,
                                       const PairBlock& block) const {
  const float* with = pair_scale_.data() + fluid * fluids_;
  Wide result;
  for (int k = 0; k < kWide; ++k)
    result[k] = with[particles.fluid[block.base + block.offset[static_cast<std::size_t>(k)]]];
  return result;
}

inline Wide ViscousForces::varying_scales(float viscosity, const FluidParticles& particles,
                                          const PairBlock& block) const {
  Wide other;
  for (int k = 0; k < kWide; ++k)
    other[k] = particles.viscosity[block.base + block.offset[static_cast<std::size_t>(k)]];
  constexpr float least = std::numeric_limits<float>::min();
  return 2 * weight_.scale() * ((viscosity * other) / (viscosity + other).max(least));
}

template <class Visit>
inline void ViscousForces::for_pairs(std::size_t i, const FluidParticles& particles,
                                     const NeighbourLists& lists, const Visit& visit) const {
  const Vec4f xi = particles.position[i];
  Wide scale = Wide::Constant(pair_scale_.front());
  for (const PairBlock& block : lists.of(i)) {
    const WideVec xj = gather(particles.position, block);
    const Wide x = xi[0] - xj.x, y = xi[1] - xj.y, z = xi[2] - xj.z;
    const Wide r2 = x * x + y * y + z * z;
    if (vary())
      scale = varying_scales(particles.viscosity[i], particles, block);
    else if (fluids_ > 1)
      scale = pair_scales(particles.fluid[i], particles, block);
    const Wide weight = scale * block.present() * weight_.shape(r2);
    visit(block, WideVec{x, y, z, r2}, weight, xj);
  }
}

inline Vec4f ViscousForces::resistance(std::size_t i, const FluidParticles& particles,
                                       const NeighbourLists& lists, const WallSums& walls,
                                       const std::vector<Vec4f>& v) const {
  PairResistance sum(i, v);
  for_pairs(
      i, particles, lists,
      [&](const PairBlock& block, const WideVec& x, const Wide& weight, const WideVec&)
          __attribute__((always_inline)) { sum.add(block, x, weight); });
  return sum.sum() + wall_drag(i, particles, walls, v[i]);
}

}  // namespace kappaflow
