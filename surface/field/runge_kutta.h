// Explicit Runge-Kutta steps of a set of points through a moving field.
#pragma once

#include <span>
#include <vector>

#include "core/parallel.h"
#include "surface/field/field.h"
#include "surface/field/time_integrator.h"

namespace kappaflow {

/// A stage of the tableaux whose stages each use the previous slope only.
struct RungeKuttaStage {
  double time = 0;    ///< c: the stage's time and the share of the previous slope that leads to its positions
  double weight = 0;  ///< b: the stage's share of the step
};

/// The stages of a method, in order: one, two or four.
std::span<const RungeKuttaStage> runge_kutta_stages(TimeIntegrator integrator);

/// Moves points from motion.t0() to motion.t1(); keeps its scratch, so that steps allocate nothing.
class RungeKutta {
 public:
  /// velocity(field, position) returns the velocities [m/s] of points at a stage's time and positions as a
  /// span that stays valid until the next call.
  template <class Velocity>
  void advance(FieldMotion& motion, TimeIntegrator integrator, std::span<Vec3> position,
               const Velocity& velocity);

 private:
  std::vector<Vec3> stage_position_;
  std::vector<Vec3> displacement_;
};

template <class Velocity>
void RungeKutta::advance(FieldMotion& motion, TimeIntegrator integrator, std::span<Vec3> position,
                         const Velocity& velocity) {
  const double t0 = motion.t0(), dt = motion.t1() - t0;
  stage_position_.assign(position.begin(), position.end());
  displacement_.assign(position.size(), Vec3::Zero());
  const std::span<const RungeKuttaStage> stages = runge_kutta_stages(integrator);
  for (std::size_t s = 0; s < stages.size(); ++s) {
    const double t = stages[s].time == 1 ? motion.t1() : t0 + stages[s].time * dt;
    const std::span<const Vec3> slope = velocity(*motion.at(t), std::span<const Vec3>(stage_position_));
    const double to_next = s + 1 < stages.size() ? stages[s + 1].time * dt : 0;
    parallel_for(position.size(), [&](std::size_t v) {
      displacement_[v] += stages[s].weight * dt * slope[v];
      stage_position_[v] = position[v] + to_next * slope[v];
    });
  }
  parallel_for(position.size(), [&](std::size_t v) { position[v] += displacement_[v]; });
}

}  // namespace kappaflow
