#include "solver/rigid_bodies.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/parallel.h"
#include "solver/halo.h"

namespace kappaflow {
namespace {

using rigid::Matrix6;
using rigid::Vector6;

// Share of a body's surface that is wet from which on it begins to count as all of it.
constexpr double kNearlyWet = 0.9;
// With fewer contacts a body of a few spacings is among spray, not in liquid.
constexpr std::size_t kFewestContacts = 24;
// Bullet's largest.
constexpr double kMostFriction = 10;

/// The rotation by |turn| [rad] about it.
Eigen::Quaterniond rotation_by(const Vec3& turn) {
  const double angle = turn.norm();
  if (!(angle > 0)) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle));
}

void check(const RigidBody& body) {
  const auto refuse = [](const char* what, double value, const char* allowed) {
    throw InvalidInput(fmt::format("a body's {} = {}; must be {}", what, value, allowed));
  };
  if (!(body.mass > 0) || !std::isfinite(body.mass)) refuse("mass", body.mass, "above 0 kg");
  if (!(body.friction >= 0 && body.friction <= kMostFriction))
    refuse("friction", body.friction, "from 0 to 10");
  if (!body.velocity.allFinite()) refuse("velocity", body.velocity.norm(), "finite");
  if (!body.angular_velocity.allFinite()) refuse("angular velocity", body.angular_velocity.norm(), "finite");
  if (!body.solid.motion().at_rest())
    throw InvalidInput("a body's solid has a motion of its own; must have none");
}

}  // namespace

MassProperties mass_properties(const TriangleSurface& surface) {
  MassProperties result;
  // Tetrahedra from a point near the surface: less is lost where volumes cancel.
  const Vec3 origin = surface.vertices.front();
  Vec3 moment = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (const auto& [i, j, k] : surface.triangles) {
    Mat3 corners;
    corners << surface.vertices[i] - origin, surface.vertices[j] - origin, surface.vertices[k] - origin;
    const double volume = corners.determinant() / 6;
    const Vec3 sum = corners.rowwise().sum();
    result.volume += volume;
    moment += volume / 4 * sum;
    second += volume / 20 * (corners * corners.transpose() + sum * sum.transpose());
  }
  const Vec3 arm = moment / result.volume;
  const Mat3 about = second / result.volume - arm * arm.transpose();
  result.centre = origin + arm;
  result.inertia = about.trace() * Mat3::Identity() - about;
  return result;
}

RigidBodies::Body::Body(const RigidBody& described_, double particle)
    : described(described_),
      weight(mass_properties(described.solid.surface())),
      mass(described.mass / particle),
      centre(weight.centre) {
  motion.head<3>() = described.velocity;
  motion.tail<3>() = described.angular_velocity;
  for (const Vec3& x : described.solid.surface().vertices) reach = std::max(reach, (x - centre).norm());
}

RigidBodies::RigidBodies(std::span<const RigidBody> bodies, double density, double spacing) {
  const double particle = density * spacing * spacing * spacing;
  for (const RigidBody& described : bodies) {
    check(described);
    bodies_.emplace_back(described, particle);
  }
}

BodyState RigidBodies::state(std::size_t b) const {
  const Body& body = bodies_[b];
  const Mat3 rotation = body.turned.toRotationMatrix();
  return {{rotation, body.centre - rotation * body.weight.centre},
          {body.motion.head<3>(), body.motion.tail<3>(), body.centre}};
}

Mat3 RigidBodies::inertia(const Body& body) const {
  const Mat3 rotation = body.turned.toRotationMatrix();
  return body.mass * rotation * body.weight.inertia * rotation.transpose();
}

Matrix6 RigidBodies::mass(std::size_t b) const {
  Matrix6 result = Matrix6::Zero();
  result.topLeftCorner<3, 3>() = bodies_[b].mass * Mat3::Identity();
  result.bottomRightCorner<3, 3>() = inertia(bodies_[b]);
  return result;
}

void RigidBodies::move(std::size_t b, double dt, const Vec3& shift, const Vec3& turn) {
  Body& body = bodies_[b];
  const Vec3 momentum = inertia(body) * body.motion.tail<3>();
  body.centre += dt * body.motion.head<3>() + shift;
  body.turned = (rotation_by(dt * body.motion.tail<3>() + turn) * body.turned).normalized();
  body.motion.tail<3>() = inertia(body).inverse() * momentum;
}

void RigidBodies::accelerate(const Vec3& gravity, double dt) {
  for (Body& body : bodies_) {
    body.motion.head<3>() += dt * gravity;
    body.motion += dt * body.contact;
  }
}

void RigidBodies::forget_contact(double dt) {
  for (Body& body : bodies_) {
    body.motion -= dt * body.contact;
    body.contact.setZero();
  }
}

void RigidBodies::note_contact(std::size_t b, const Vector6& motion, double dt) {
  Body& body = bodies_[b];
  body.contact = (motion - body.motion) / dt;
  body.motion = motion;
}

double RigidBodies::fastest() const {
  double speed = 0;
  for (const Body& body : bodies_) {
    const double own = body.motion.head<3>().norm() + body.motion.tail<3>().norm() * body.reach;
    speed = std::isfinite(own) ? std::max(speed, own) : kInfinity;
  }
  return speed;
}

void RigidBodies::find_contacts(FluidParticles& particles, const Walls& walls, WallSums& sums) {
  if (none()) return;
  for (Body& body : bodies_) body.contacts.clear();
  diagonal_.assign(sums.friction.size(), 0);
  for (std::uint32_t i = 0; i < particles.size(); ++i)
    for (std::uint32_t k = sums.first[i]; k < sums.first[i + 1]; ++k)
      if (sums.body[k] != WallSums::kPrescribed) bodies_[sums.body[k]].contacts.push_back({i, k});
  for (std::size_t b = 0; b < size(); ++b) {
    even_out(b, std::clamp((walls.wet_share(b) - kNearlyWet) / (1 - kNearlyWet), 0.0, 1.0), particles, sums);
    const Body& body = bodies_[b];
    const Mat3 inverse = inertia(body).inverse();
    parallel_for(body.contacts.size(), [&](std::size_t c) {
      const auto [i, k] = body.contacts[c];
      const Vec3 g = sums.gradient[k].head<3>().cast<double>(), torque = arm(b, i, particles).cross(g);
      diagonal_[k] = static_cast<float>(g.squaredNorm() / body.mass + torque.dot(inverse * torque));
    });
  }
}

void RigidBodies::even_out(std::size_t b, double share, FluidParticles& particles, WallSums& sums) {
  const std::span<const BodyContact> contacts = bodies_[b].contacts;
  if (!(share > 0) || sum_of_ranks(particles, contacts.size()) < kFewestContacts) return;
  const auto gradient = [&](const BodyContact& c) -> Vec3 {
    return sums.gradient[c.contact].head<3>().cast<double>();
  };
  const Matrix6 no_matrix = Matrix6::Zero();
  const Matrix6 own_weights = parallel_sum(contacts.size(), no_matrix, [&](std::size_t c) -> Matrix6 {
    const auto j = rigid::velocities_at(arm(b, contacts[c].particle, particles));
    return gradient(contacts[c]).norm() * j.transpose() * j;
  });
  const Vector6 none = Vector6::Zero();
  const Vector6 own_sum = parallel_sum(contacts.size(), none, [&](std::size_t c) -> Vector6 {
    return rigid::load_of(gradient(contacts[c]), arm(b, contacts[c].particle, particles));
  });
  const Matrix6 weights = sum_of_ranks(particles, own_weights);
  const Vector6 sum = sum_of_ranks(particles, own_sum);
  const Vector6 q = share * weights.ldlt().solve(sum);
  parallel_for(contacts.size(), [&](std::size_t c) {
    const auto [i, k] = contacts[c];
    const Vec4f taken = padded(gradient(contacts[c]).norm() * rigid::velocity_at(q, arm(b, i, particles)));
    sums.gradient[k] -= taken;
    particles.gradient_sum[i] -= taken;
  });
}

void RigidBodies::drive(std::size_t b, const FluidParticles& particles, WallSums& walls) const {
  const Body& body = bodies_[b];
  parallel_for(body.contacts.size(), [&](std::size_t c) {
    const auto [i, k] = body.contacts[c];
    const Vec3 u = rigid::velocity_at(body.motion, arm(b, i, particles));
    Vec4f& velocity = walls.velocity[k];
    velocity = padded(u);
    velocity[3] = -static_cast<float>(u.dot(walls.gradient[k].head<3>().cast<double>()));
  });
}

void RigidBodies::drive(const FluidParticles& particles, WallSums& walls) const {
  for (std::size_t b = 0; b < size(); ++b) drive(b, particles, walls);
}

void RigidBodies::find_push(const FluidParticles& particles, const WallSums& walls) {
  loads_.resize(size());
  for (std::size_t b = 0; b < size(); ++b) {
    const Body& body = bodies_[b];
    const Vector6 zero = Vector6::Zero();
    loads_[b] = parallel_sum(body.contacts.size(), zero, [&](std::size_t c) -> Vector6 {
      const auto [i, k] = body.contacts[c];
      const Vec3 force =
          static_cast<double>(particles.position[i][3]) * walls.gradient[k].head<3>().cast<double>();
      return rigid::load_of(force, arm(b, i, particles));
    });
  }
  sum_each_of_ranks(particles, loads_);
  for (std::size_t b = 0; b < size(); ++b) {
    Body& body = bodies_[b];
    body.push.head<3>() = loads_[b].head<3>() / body.mass;
    body.push.tail<3>() = inertia(body).inverse() * loads_[b].tail<3>();
  }
}

float RigidBodies::push_rate(std::size_t i, const FluidParticles& particles, const WallSums& walls) const {
  double sum = 0;
  for (std::uint32_t k = walls.first[i]; k < walls.first[i + 1]; ++k) {
    const std::uint32_t b = walls.body[k];
    if (b == WallSums::kPrescribed) continue;
    const Vec3 u = rigid::velocity_at(bodies_[b].push, arm(b, i, particles));
    sum -= u.dot(walls.gradient[k].head<3>().cast<double>());
  }
  return static_cast<float>(sum);
}

float RigidBodies::push_diagonal(std::size_t i, const WallSums& walls) const {
  float sum = 0;
  for (std::uint32_t k = walls.first[i]; k < walls.first[i + 1]; ++k) sum += diagonal_[k];
  return sum;
}

double RigidBodies::push_square() const {
  double sum = 0;
  for (std::size_t b = 0; b < size(); ++b) sum += bodies_[b].push.dot(mass(b) * bodies_[b].push);
  return sum;
}

void RigidBodies::scale_push(double factor) {
  for (Body& body : bodies_) body.push *= factor;
}

void RigidBodies::apply_push(double time) {
  for (Body& body : bodies_) body.motion += time * body.push;
}

std::size_t RigidBodies::bytes() const {
  std::size_t sum = bytes_of(diagonal_);
  for (const Body& body : bodies_) sum += bytes_of(body.contacts);
  return sum;
}

}  // namespace kappaflow
