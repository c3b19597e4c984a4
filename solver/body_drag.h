// What viscosity does to rigid bodies, and they to it.
#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "solver/boundary.h"
#include "solver/fluid_particles.h"
#include "solver/rigid_bodies.h"
#include "solver/viscous_forces.h"

namespace kappaflow {

/// Of the implicit viscosity of liquid and bodies together,
///   (M + dt sum J^T R J) u - dt sum J^T R v = M u*,   v + dt L v - dt R J u = v*,
/// with u a body's motion, M its mass, R_k = nu' g (I - n n^T) of its contacts k (viscous_forces.h), J from
/// motions to velocities at the particles, u is eliminated:
///   u = S^-1 (M u* + dt sum J^T R v),   S = M + dt sum J^T R J.
/// What is left for v is symmetric and at least the identity, as without bodies, and needs no unknowns of its
/// own. Liquid and body that turn as one rub nowhere, for J is that at the particle, where the force acts
/// too: angular momentum is kept. Masses are over that of a particle.
class BodyDrag {
 public:
  /// u*: the bodies' velocities now. Without bodies (nullptr) the functions do nothing.
  BodyDrag(const ViscousForces& forces, RigidBodies* bodies, const FluidParticles& particles, WallSums& walls,
           float time_step);

  /// Finds S, of the viscosities as they are.
  void set_up();
  /// The bodies' velocities u for those of the liquid; also WallSums::velocity.
  void respond(const std::vector<Vec4f>& v);
  /// q = A p of bodies at rest -> that of bodies that respond. Returns the change of p . q.
  double respond_to(const std::vector<Vec4f>& p, std::vector<Vec4f>& q);

  std::size_t bodies() const { return bodies_ == nullptr ? 0 : bodies_->size(); }
  std::span<const BodyContact> contacts(std::size_t b) const { return bodies_->contacts(b); }
  /// What the body's response takes from dt R where the liquid moves by q, a rigid motion about `centre`:
  /// C S^-1 C^T, C = dt sum B^T R J with B q the velocities.
  rigid::Matrix6 yielding(std::size_t b, const Vec3& centre) const;

 private:
  /// dt R u of a contact.
  Vec4f drag(const BodyContact& contact, const Vec4f& u) const {
    return time_step_ * forces_.contact_drag(contact.particle, contact.contact, particles_, walls_, u);
  }
  /// dt R of a contact.
  Mat3 resistance(const BodyContact& contact) const;
  /// dt sum J^T R v, by body.
  void find_loads(const std::vector<Vec4f>& v);

  const ViscousForces& forces_;
  RigidBodies* bodies_;
  const FluidParticles& particles_;
  WallSums& walls_;
  float time_step_;
  std::vector<rigid::Vector6> momentum_;             // M u*, by body
  std::vector<rigid::Vector6> loads_;                // see find_loads()
  std::vector<Eigen::LLT<rigid::Matrix6>> factors_;  // of S
};

}  // namespace kappaflow
