// The liquid's particles as the solver holds them: structure of arrays in cell order, single precision.
#pragma once

#ifdef __F16C__
#include <immintrin.h>
#endif

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "core/bytes.h"
#include "core/types.h"

namespace kappaflow {

class Halo;

/// Columns of a 3x3 matrix, each padded to one register; times a 3-vector it gives a padded vector.
using Mat43f = Eigen::Matrix<float, 4, 3>;

/// In half precision.
using Vec4h = Eigen::Matrix<Eigen::half, 4, 1>;

/// v in half precision, too large numbers as the largest.
inline Vec4h halved(const Vec4f& v) {
  constexpr float most = 65504;
  const Vec4f within = v.cwiseMax(-most).cwiseMin(most);
#ifdef __F16C__
  Vec4h result;
  const __m128i halves = _mm_cvtps_ph(_mm_load_ps(within.data()), _MM_FROUND_TO_NEAREST_INT);
  _mm_storel_epi64(reinterpret_cast<__m128i*>(result.data()), halves);
  return result;
#else
  return within.cast<Eigen::half>();
#endif
}

/// The other way.
inline Vec4f widened(const Vec4h& v) {
#ifdef __F16C__
  Vec4f result;
  _mm_store_ps(result.data(), _mm_cvtph_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(v.data()))));
  return result;
#else
  return v.cast<float>();
#endif
}

/// v in single precision with a fourth component of 0.
inline Vec4f padded(const Vec3& v) {
  const Eigen::Vector3f f = v.cast<float>();
  return {f.x(), f.y(), f.z(), 0};
}

/// All arrays but `mass_of_fluid` have one entry a particle; where ranks share the liquid (halo.h) some have
/// the ghosts' entries behind them. Every particle has the same rest volume spacing^3.
struct FluidParticles {
  // The state: carried from step to step, permuted when the particles are sorted.
  std::vector<std::uint32_t> id;
  std::vector<Vec4f> position;          ///< [m]; w: kappa of the pressure solve that runs, see pressure.h
  std::vector<Vec4f> velocity;          ///< [m/s]
  std::vector<Vec4f> viscous_velocity;  ///< after the last step's viscosity [m/s]; starts the next solve
  /// Its change in the last step (weak fluids: what viscosity changed) over that step: for a first guess
  /// [m/s2].
  std::vector<Vec4h> viscous_acceleration;
  std::vector<float> density_pressure;     ///< kappa of the constant-density solve [m2/s2], see pressure.h
  std::vector<float> divergence_pressure;  ///< kappa of the divergence-free solve [m2/s2]
  std::vector<float> least_pressure;  ///< least kappa of the former, <= 0, see viscous_pressure.h [m2/s2]
  std::vector<std::uint8_t> fluid;    ///< which of the fluids of FluidOptions it belongs to
  std::vector<std::uint8_t> led_by;   ///< 0: free; k + 1: keeps the velocity of emitter k
  std::vector<int> source;            ///< where it comes from, by the caller's numbers

  std::vector<double> temperature;  ///< [K]; empty where there is no heat

  /// By all ranks since the start, those that are gone included: the ids below have been used.
  std::uint64_t made = 0;

  /// By fluid: mass of its particles over that of fluid 0's [1]; empty where all have the same.
  std::vector<float> mass_of_fluid;

  // What follows from the positions: recomputed after every move.
  std::vector<float> density;              ///< over the rest density [1]
  std::vector<Vec4f> gradient_sum;         ///< density's gradient in the particle's own position [1/m]
  std::vector<float> gradient_square_sum;  ///< sum_j |V grad W_ij|^2 / m_j, m: mass() [1/m2]

  // What follows from them and the velocities while viscosity is solved for, and until the next step: see
  // ViscousForces::find_viscosities(). Empty where every fluid is Newtonian.
  std::vector<float> viscosity;       ///< dynamic, over the rest density of fluid 0 [m2/s]
  std::vector<float> wall_viscosity;  ///< the same at a wall, with its slip

  // Room for what a phase of a step needs while it runs; the next phase overwrites it.
  std::array<std::vector<Vec4f>, 3> scratch;
  std::vector<float> scalar_scratch;

  Halo* halo = nullptr;  ///< where ranks share the liquid

  std::size_t size() const { return id.size(); }
  bool masses_differ() const { return !mass_of_fluid.empty(); }
  /// Of a particle over that of fluid 0's [1].
  float mass(std::size_t i) const { return masses_differ() ? mass_of_fluid[fluid[i]] : 1; }

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(id, position, velocity, viscous_velocity, viscous_acceleration, density_pressure,
            divergence_pressure, least_pressure, fluid, led_by, source, temperature, made);
  }

  /// Calls visit(member) for the arrays of the state that have one entry a particle.
  template <class Visit>
  static void for_state(bool heat, const Visit& visit) {
    const auto each = [&](auto... members) { (visit(members), ...); };
    using P = FluidParticles;
    each(&P::id, &P::position, &P::velocity, &P::viscous_velocity, &P::viscous_acceleration,
         &P::density_pressure, &P::divergence_pressure, &P::least_pressure, &P::fluid, &P::led_by,
         &P::source);
    if (heat) visit(&P::temperature);
  }

  /// To be called before particles move, come or go.
  void drop_ghosts() {
    const auto cut = [this](auto&... arrays) { (arrays.resize(std::min(arrays.size(), size())), ...); };
    cut(position, velocity, viscous_velocity, fluid, led_by, temperature);
  }

  /// Leaves the particles of these indices, which ascend, and takes the others away. What follows from the
  /// positions is then out of date.
  void keep(const std::vector<std::uint32_t>& kept) {
    const auto keep_in = [&](auto&... arrays) {
      const auto in_one = [&](auto& array) {
        for (std::size_t k = 0; k < kept.size(); ++k) array[k] = array[kept[k]];
        array.resize(kept.size());
      };
      (in_one(arrays), ...);
    };
    keep_in(id, position, velocity, viscous_velocity, viscous_acceleration, density_pressure,
            divergence_pressure, least_pressure, fluid, led_by, source);
    if (!temperature.empty()) keep_in(temperature);
  }

  /// Gives back what many more particles have taken.
  void shrink() {
    const auto in_each = [](auto&... arrays) { (arrays.shrink_to_fit(), ...); };
    in_each(id, position, velocity, viscous_velocity, viscous_acceleration, density_pressure,
            divergence_pressure, least_pressure, fluid, led_by, source, temperature);
  }

  std::size_t bytes() const {
    return bytes_of(id, position, velocity, viscous_velocity, viscous_acceleration, density_pressure,
                    divergence_pressure, least_pressure, fluid, led_by, source, temperature, density,
                    gradient_sum, gradient_square_sum, viscosity, wall_viscosity, scratch[0], scratch[1],
                    scratch[2], scalar_scratch, mass_of_fluid);
  }

  /// Appends a particle without pressure; its id is the number of those made before.
  void add(const Vec3& x, const Vec3& v, std::uint8_t of_fluid, std::uint8_t emitter, int from) {
    id.push_back(static_cast<std::uint32_t>(made++));
    position.push_back(padded(x));
    velocity.push_back(padded(v));
    viscous_velocity.push_back(padded(v));
    viscous_acceleration.push_back(Vec4h::Zero());
    density_pressure.push_back(0);
    divergence_pressure.push_back(0);
    least_pressure.push_back(0);
    fluid.push_back(of_fluid);
    led_by.push_back(emitter);
    source.push_back(from);
  }
};

}  // namespace kappaflow
