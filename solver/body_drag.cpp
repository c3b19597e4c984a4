#include "solver/body_drag.h"

#include "core/parallel.h"

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
  factors_.clear();
  for (std::size_t b = 0; b < bodies(); ++b) {
    const std::span<const BodyContact> contacts = bodies_->contacts(b);
    const Matrix6 zero = Matrix6::Zero();
    const Matrix6 sum = parallel_sum(contacts.size(), zero, [&](std::size_t c) -> Matrix6 {
      const auto j = velocities_at(bodies_->arm(b, contacts[c].particle, particles_));
      return j.transpose() * resistance(contacts[c]) * j;
    });
    factors_.emplace_back(bodies_->mass(b) + sum);
  }
}

Vector6 BodyDrag::load(std::size_t b, const std::vector<Vec4f>& v) const {
  const std::span<const BodyContact> contacts = bodies_->contacts(b);
  const Vector6 zero = Vector6::Zero();
  return parallel_sum(contacts.size(), zero, [&](std::size_t c) -> Vector6 {
    const std::uint32_t i = contacts[c].particle;
    const Vec3 force = drag(contacts[c], v[i]).head<3>().cast<double>();
    return rigid::load_of(force, bodies_->arm(b, i, particles_));
  });
}

void BodyDrag::respond(const std::vector<Vec4f>& v) {
  for (std::size_t b = 0; b < bodies(); ++b) {
    bodies_->set_motion(b, factors_[b].solve(momentum_[b] + load(b, v)));
    bodies_->drive(b, particles_, walls_);
  }
}

double BodyDrag::respond_to(const std::vector<Vec4f>& p, std::vector<Vec4f>& q) const {
  double change = 0;
  for (std::size_t b = 0; b < bodies(); ++b) {
    const Vector6 of_p = load(b, p), motion = factors_[b].solve(of_p);
    change -= of_p.dot(motion);
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
  const Matrix6 coupling = parallel_sum(contacts.size(), zero, [&](std::size_t c) -> Matrix6 {
    const std::uint32_t i = contacts[c].particle;
    if (!forces_.act_on(i, particles_)) return Matrix6::Zero();
    const Vec3 x = particles_.position[i].head<3>().cast<double>();
    return velocities_at(x - centre).transpose() * resistance(contacts[c]) *
           velocities_at(bodies_->arm(b, i, particles_));
  });
  return coupling * factors_[b].solve(coupling.transpose());
}

}  // namespace kappaflow
