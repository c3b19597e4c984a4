// Fields with a known surface, motion and topology, for the tests of the mesh and of the tracker.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>

#include "surface/field/field.h"
#include "surface/field/particle_field.h"

namespace kappaflow::testing {

/// f = 1 - (x-c)^T M (x-c), M = R diag(1/a^2) R^T: an ellipsoid with semi-axes a that moves rigidly with the
/// velocity u + omega x (x - c).
class EllipsoidField final : public Field {
 public:
  EllipsoidField(const Vec3& centre, const Mat3& rotation, const Vec3& semi_axes,
                 const Vec3& velocity = Vec3::Zero(), const Vec3& angular_velocity = Vec3::Zero(),
                 double time = 0)
      : centre_(centre),
        M_(rotation * semi_axes.cwiseAbs2().cwiseInverse().asDiagonal() * rotation.transpose()),
        velocity_(velocity),
        angular_velocity_(angular_velocity),
        smallest_axis_(semi_axes.minCoeff()),
        largest_axis_(semi_axes.maxCoeff()),
        time_(time) {
    const Mat3 spin = cross_matrix(angular_velocity);
    M_t_ = spin * M_ - M_ * spin;
  }

  double time() const override { return time_; }
  Jet jet(const Vec3& x) const override {
    const Vec3 d = x - centre_;
    Jet jet;
    jet.f = 1 - d.dot(M_ * d);
    jet.g = -2 * M_ * d;
    jet.A = -2 * M_;
    jet.f_t = -jet.g.dot(rigid_velocity(x));
    jet.g_t = -2 * (M_t_ * d - M_ * velocity_);
    jet.A_t = -2 * M_t_;
    jet.length_scale = smallest_axis_;
    jet.fastest_in_reach = fastest_speed();
    return jet;
  }
  ValueAndGradient value_and_gradient(const Vec3& x) const override {
    const Vec3 d = x - centre_;
    return {1 - d.dot(M_ * d), -2 * M_ * d};
  }
  Bounds bounds() const override {
    return {centre_ - Vec3::Constant(largest_axis_), centre_ + Vec3::Constant(largest_axis_)};
  }
  double length_scale() const override { return smallest_axis_; }
  double fastest_speed() const override {
    return velocity_.norm() + 2 * angular_velocity_.norm() * largest_axis_;
  }
  std::optional<Vec3> material_velocity(const Vec3& x) const override { return rigid_velocity(x); }

 private:
  static Mat3 cross_matrix(const Vec3& w) {
    Mat3 m;
    m << 0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0;
    return m;
  }
  Vec3 rigid_velocity(const Vec3& x) const { return velocity_ + angular_velocity_.cross(x - centre_); }

  Vec3 centre_;
  Mat3 M_, M_t_;
  Vec3 velocity_, angular_velocity_;
  double smallest_axis_, largest_axis_, time_;
};

/// f = (4 R^2 (x^2+y^2) - (|x|^2 + R^2 - r^2)^2) / (8 R^2 r): a torus about the z axis, |g| = O(1) on it.
class TorusField final : public Field {
 public:
  TorusField(double major, double minor) : R_(major), r_(minor) {}
  double time() const override { return 0; }
  Jet jet(const Vec3& x) const override {
    const double scale = 1 / (8 * R_ * R_ * r_), q = x.squaredNorm() + R_ * R_ - r_ * r_;
    const Mat3 in_plane = Vec3(1, 1, 0).asDiagonal();
    Jet jet;
    jet.f = scale * (4 * R_ * R_ * (x[0] * x[0] + x[1] * x[1]) - q * q);
    jet.g = scale * (8 * R_ * R_ * in_plane * x - 4 * q * x);
    jet.A = scale * (8 * R_ * R_ * in_plane - 4 * q * Mat3::Identity() - 8 * x * x.transpose());
    jet.length_scale = r_;
    return jet;
  }
  ValueAndGradient value_and_gradient(const Vec3& x) const override {
    const Jet at = jet(x);
    return {at.f, at.g};
  }
  Bounds bounds() const override { return {Vec3(-R_ - r_, -R_ - r_, -r_), Vec3(R_ + r_, R_ + r_, r_)}; }
  double length_scale() const override { return r_; }
  double fastest_speed() const override { return 0; }

 private:
  double R_, r_;
};

/// Particles of one sigma and weight 1 that turn rigidly about the z axis.
inline FieldParticles rotating_particles(const std::vector<Vec3>& position, double sigma,
                                         double angular_speed) {
  FieldParticles particles;
  particles.position = position;
  for (const Vec3& x : position) particles.velocity.push_back(angular_speed * Vec3::UnitZ().cross(x));
  particles.sigma.assign(position.size(), sigma);
  particles.weight.assign(position.size(), 1.0);
  particles.weight_rate.assign(position.size(), 0.0);
  return particles;
}

/// Random blobs: particles uniform in a cube of the given half width, sigma = 1, threshold 0.5.
inline ParticleField random_blobs(unsigned seed, int count, double half_width) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> along(-half_width, half_width);
  std::vector<Vec3> position(count);
  for (Vec3& x : position) x = {along(random), along(random), along(random)};
  return ParticleField(rotating_particles(position, 1.0, 1.0), 0.5, 0.0);
}

/// A field at any time through a function of time.
template <class FieldAt>
class FunctionMotion final : public FieldMotion {
 public:
  FunctionMotion(double t0, double t1, FieldAt field_at) : t0_(t0), t1_(t1), field_at_(std::move(field_at)) {}
  double t0() const override { return t0_; }
  double t1() const override { return t1_; }
  std::shared_ptr<const Field> at(double t) override {
    auto& field = fields_[t];
    if (!field) field = field_at_(t);
    return field;
  }

 private:
  double t0_, t1_;
  FieldAt field_at_;
  std::map<double, std::shared_ptr<const Field>> fields_;
};

inline Mat3 rotation(const Vec3& angle) {
  return angle.norm() > 0 ? Eigen::AngleAxisd(angle.norm(), angle.normalized()).toRotationMatrix()
                          : Mat3::Identity();
}

/// Particles that turn exactly about the z axis with angular speed 2 pi: one turn a second.
inline auto turning_particles(double t0, double t1, std::vector<Vec3> start, double sigma, double threshold) {
  constexpr double kAngularSpeed = 2 * std::numbers::pi;
  return FunctionMotion(t0, t1, [=](double t) -> std::shared_ptr<const Field> {
    std::vector<Vec3> position = start;
    for (Vec3& x : position) x = rotation(kAngularSpeed * t * Vec3::UnitZ()) * x;
    return std::make_shared<ParticleField>(rotating_particles(position, sigma, kAngularSpeed), threshold, t);
  });
}

}  // namespace kappaflow::testing
