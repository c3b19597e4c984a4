#include "solver/body_drag.h"

#include "core/parallel.h"
#include "solver/halo.h"

namespace kappaflow {

using rigid::Matrix6;
using rigid::Vector6;
using rigid::velocities_at;

BodyDrag::BodyDrag(const ViscousForces& forces, RigidBodies* bodies, const FluidParticles& particles,
                   WallSums& walls, float time_step)
    : forces_(forces), bodies_(bodies), particles_(particles), walls_(walls), time_step_(time_step) {
  for (std::size_t b = 0; b < this->bodies(); ++b) {
    momentum_.emplace_back(bodies_->mass(b) * bodies_->motion(b));
    bodies_->drive(b, particles_, walls_);
  }
}

Mat3 BodyDrag::resistance(const BodyContact& contact) const {
  Mat3 result;
  for (int axis = 0; axis < 3; ++axis)
    result.col(axis) = drag(contact, Vec4f::Unit(axis)).head<3>().cast<double>();
  return result;
}

void BodyDrag::set_up() {
  std::vector<Matrix6> sums;
  for (std::size_t b = 0; b < bodies(); ++b) {
    const std::span<const BodyContact> contacts = bodies_->contacts(b);
    const Matrix6 zero = Matrix6::Zero();
    sums.push_back(parallel_sum(contacts.size(), zero, [&](std::size_t c) -> Matrix6 {
      const auto j = velocities_at(bodies_->arm(b, contacts[c].particle, particles_));
      return j.transpose() * resistance(contacts[c]) * j;
    }));
  }
  sum_each_of_ranks(particles_, sums);
  factors_.clear();
  for (std::size_t b = 0; b < bodies(); ++b) factors_.emplace_back(bodies_->mass(b) + sums[b]);
}

void BodyDrag::find_loads(const std::vector<Vec4f>& v) {
  loads_.resize(bodies());
  for (std::size_t b = 0; b < bodies(); ++b) {
    const std::span<const BodyContact> contacts = bodies_->contacts(b);
    const Vector6 zero = Vector6::Zero();
    loads_[b] = parallel_sum(contacts.size(), zero, [&](std::size_t c) -> Vector6 {
      const std::uint32_t i = contacts[c].particle;
      const Vec3 force = drag(contacts[c], v[i]).head<3>().cast<double>();
      return rigid::load_of(force, bodies_->arm(b, i, particles_));
    });
  }
  sum_each_of_ranks(particles_, loads_);
}

void BodyDrag::respond(const std::vector<Vec4f>& v) {
  find_loads(v);
  for (std::size_t b = 0; b < bodies(); ++b) {
    bodies_->set_motion(b, factors_[b].solve(momentum_[b] + loads_[b]));
    bodies_->drive(b, particles_, walls_);
  }
}

double BodyDrag::respond_to(const std::vector<Vec4f>& p, std::vector<Vec4f>& q) {
  double change = 0;
  find_loads(p);
  for (std::size_t b = 0; b < bodies(); ++b) {
    const Vector6 motion = factors_[b].solve(loads_[b]);
    change -= loads_[b].dot(motion);
    const std::span<const BodyContact> contacts = bodies_->contacts(b);
    parallel_for(contacts.size(), [&](std::size_t c) {
      const std::uint32_t i = contacts[c].particle;
      q[i] -= drag(contacts[c], padded(rigid::velocity_at(motion, bodies_->arm(b, i, particles_))));
    });
  }
  return change;
}

Matrix6 BodyDrag::yielding(std::size_t b, const Vec3& centre) const {
  const std::span<const BodyContact> contacts = bodies_->contacts(b);
  const Matrix6 zero = Matrix6::Zero();
  const Matrix6 own = parallel_sum(contacts.size(), zero, [&](std::size_t c) -> Matrix6 {
    const std::uint32_t i = contacts[c].particle;
    if (!forces_.act_on(i, particles_)) return Matrix6::Zero();
    const Vec3 x = particles_.position[i].head<3>().cast<double>();
    return velocities_at(x - centre).transpose() * resistance(contacts[c]) *
           velocities_at(bodies_->arm(b, i, particles_));
  });
  const Matrix6 coupling = sum_of_ranks(particles_, own);
  return coupling * factors_[b].solve(coupling.transpose());
}

}  // namespace kappaflow
