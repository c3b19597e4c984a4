// Rigid bodies in the solver's equations: their state and what pressure does to them.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "core/bytes.h"
#include "solver/boundary.h"
#include "solver/fluid_particles.h"
#include "solver/rigid_body.h"
#include "solver/rigid_motion.h"

namespace kappaflow {

/// A contact of a body with a particle: their places in FluidParticles and WallSums.
struct BodyContact {
  std::uint32_t particle, contact;
};

/// The bodies in the solver's equations. A body's velocity u_B at a particle is that of its rigid motion
/// there: in D (pressure.h) stands sum_b V_b (v_i - u_B(x_i)) . grad W_ib, for rotation moves a sample
/// against the particle across the line that joins them, and the body is pushed by the opposite of what it
/// pushes with (Akinci et al. 2012). So D M^-1 D^T of liquid and bodies together is one symmetric problem, M
/// the masses; nothing is explicit, so that bodies far lighter than the liquid are stable too. Masses
/// here are over that of a particle.
class RigidBodies {
 public:
  RigidBodies() = default;
  /// density: of the liquid [kg/m3]. Throws InvalidInput for options out of range.
  RigidBodies(std::span<const RigidBody> bodies, double density, double spacing);

  bool none() const { return bodies_.empty(); }
  std::size_t size() const { return bodies_.size(); }
  BodyState state(std::size_t b) const;
  /// Moves the body on by dt [s]. Its angular momentum stays as it is. shift, turn: what contacts move it
  /// further, in the step.
  void move(std::size_t b, double dt, const Vec3& shift = Vec3::Zero(), const Vec3& turn = Vec3::Zero());
  Eigen::Quaterniond attitude(std::size_t b) const { return bodies_[b].turned; }  ///< from that at t = 0
  const RigidBody& described(std::size_t b) const { return bodies_[b].described; }
  const MassProperties& weight(std::size_t b) const { return bodies_[b].weight; }

  /// Adds to the velocities what gravity [m/s2] does in dt [s], and what contacts did in the last step: else
  /// a body that rests on a wall would begin each step in free fall, and thick liquid flow with it.
  void accelerate(const Vec3& gravity, double dt);
  /// Takes the contacts' part away again, before those of this step are found.
  void forget_contact(double dt);
  /// The motion after its contacts, which accelerate() takes up in the next step.
  void note_contact(std::size_t b, const rigid::Vector6& motion, double dt);

  /// Upper bound of the speed of any point of a body; infinite when one is not finite [m/s].
  double fastest() const;

  /// Which particles touch which body. Evens out their gradients. After Walls::add_to().
  void find_contacts(FluidParticles& particles, const Walls& walls, WallSums& sums);
  std::span<const BodyContact> contacts(std::size_t b) const { return bodies_[b].contacts; }
  /// Writes the bodies' velocities to WallSums::velocity.
  void drive(const FluidParticles& particles, WallSums& walls) const;
  void drive(std::size_t b, const FluidParticles& particles, WallSums& walls) const;

  // Motions and loads are about the centre of mass.
  rigid::Vector6 motion(std::size_t b) const { return bodies_[b].motion; }
  void set_motion(std::size_t b, const rigid::Vector6& motion) { bodies_[b].motion = motion; }
  rigid::Matrix6 mass(std::size_t b) const;  ///< from motions to momenta [1, m2]
  Vec3 arm(std::size_t b, std::size_t particle, const FluidParticles& particles) const {
    return particles.position[particle].head<3>().cast<double>() - bodies_[b].centre;
  }

  /// Finds the accelerations by the pressure whose kappa_i is in position[i].w.
  void find_push(const FluidParticles& particles, const WallSums& walls);
  /// Their part in D a at the particle.
  float push_rate(std::size_t i, const FluidParticles& particles, const WallSums& walls) const;
  /// The diagonal of their part in D M^-1 D^T [1/m2].
  float push_diagonal(std::size_t i, const WallSums& walls) const;
  /// Their part in a . M a, over a particle's mass [m2/s4].
  double push_square() const;
  void scale_push(double factor);
  /// Adds `time` [s] times the accelerations to the velocities.
  void apply_push(double time);

  std::size_t bytes() const;

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    for (Body& body : bodies_) archive(body.centre, body.turned.coeffs(), body.motion, body.contact);
  }

 private:
  struct Body {
    Body(const RigidBody& described, double particle);  // particle: the mass of one [kg]

    RigidBody described;
    MassProperties weight;                                       // at t = 0
    double mass;                                                 // over a particle's
    Vec3 centre;                                                 // of mass, now [m]
    Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();  // from its attitude at t = 0
    rigid::Vector6 motion = rigid::Vector6::Zero();              // velocity, angular velocity
    rigid::Vector6 push = rigid::Vector6::Zero();                // their rates by pressure
    rigid::Vector6 contact = rigid::Vector6::Zero();             // and by the last step's contacts
    double reach = 0;                                            // of its points from the centre [m]
    std::vector<BodyContact> contacts;                           // by particle
  };

  /// Takes `share` of what a uniform pressure would do to the body from its gradients.
  void even_out(std::size_t b, double share, FluidParticles& particles, WallSums& sums);
  Mat3 inertia(const Body& body) const;  // now, over a particle's mass [m2]

  std::vector<Body> bodies_;
  std::vector<float> diagonal_;        // by contact: see push_diagonal()
  std::vector<rigid::Vector6> loads_;  // of find_push()
};

}  // namespace kappaflow
