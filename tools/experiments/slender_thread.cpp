#include "tools/experiments/slender_thread.h"

#include <Eigen/Geometry>
#include <Eigen/SparseLU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/errors.h"
#include "core/types.h"

namespace kappaflow {
namespace {

// Everything is in units of the height, the speed at the mouth, and 3 nu times the flow rate over the height.
constexpr int kFields = 17, kUnknowns = kFields + 2;  // of a place; with frequency and length
constexpr int kIntervals = 400;
constexpr int kMostIterations = 30;
constexpr double kConverged = 1e-9;
constexpr double kNudge = 1e-7;         // for the derivatives
constexpr double kGuessedRadius = 0.4;  // of the coil that the search begins with, in heights

using Fields = Eigen::Matrix<double, kFields, 1>;
enum At { kPlace = 0, kFrame = 3, kSpeed = 7, kBend = 8, kForce = 11, kMoment = 14 };

/// Numbers of the problem: slenderness a^2 / (4 H^2), U H / (3 nu), g H^2 / (3 nu U).
struct Numbers {
  double slenderness, inertia, gravity;
};

Mat3 frame_of(const Fields& y) {
  return Eigen::Quaterniond(y[kFrame], y[kFrame + 1], y[kFrame + 2], y[kFrame + 3]).toRotationMatrix();
}

/// d y / d s.
Fields derivative(const Fields& y, double frequency, const Numbers& numbers) {
  const Mat3 frame = frame_of(y);
  const Vec3 tangent = frame.col(2), bend = y.segment<3>(kBend), x = y.segment<3>(kPlace);
  const Vec3 force = y.segment<3>(kForce), moment = frame.transpose() * y.segment<3>(kMoment);
  const double speed = y[kSpeed], stretching = force.dot(tangent) * speed;
  const Vec3 turn(0, 0, frequency);
  const Vec3 acceleration = turn.cross(turn.cross(x)) + 2 * speed * turn.cross(tangent) +
                            speed * (stretching * tangent + speed * (frame * bend).cross(tangent));
  Fields rate;
  rate.segment<3>(kPlace) = tangent;
  const Eigen::Quaterniond q(y[kFrame], y[kFrame + 1], y[kFrame + 2], y[kFrame + 3]);
  const Eigen::Quaterniond turned = q * Eigen::Quaterniond(0, bend.x(), bend.y(), bend.z());
  rate.segment<4>(kFrame) = 0.5 * Eigen::Vector4d(turned.w(), turned.x(), turned.y(), turned.z());
  rate[kSpeed] = stretching;
  const Vec3 stiffness = numbers.slenderness / (speed * speed) * Vec3(1, 1, 2.0 / 3);
  rate.segment<3>(kBend) = (moment.cwiseQuotient(stiffness) - stretching * bend) / speed;
  rate.segment<3>(kForce) = (numbers.inertia * acceleration + Vec3(0, 0, numbers.gravity)) / speed;
  rate.segment<3>(kMoment) = force.cross(tangent);
  return rate;
}

/// What must vanish at the mouth (11) and at the plate (8).
Eigen::Matrix<double, kUnknowns, 1> ends(const Fields& mouth, const Fields& plate, double frequency) {
  const Mat3 frame = frame_of(plate);
  const Vec3 x = plate.segment<3>(kPlace), turn(0, 0, frequency);
  const Vec3 rest = plate[kSpeed] * frame.col(2) + turn.cross(x);
  Eigen::Matrix<double, kUnknowns, 1> r;
  r.segment<3>(0) = mouth.segment<3>(kPlace);
  r.segment<4>(3) = mouth.segment<4>(kFrame) - Eigen::Vector4d(0, 1, 0, 0);
  r[7] = mouth[kSpeed] - 1;
  r.segment<3>(8) = mouth.segment<3>(kBend) - Vec3(0, 0, frequency);
  r.segment<4>(11) = Eigen::Vector4d(x.z() + 1, frame(2, 2), rest.x(), rest.y());
  r.segment<3>(15) = plate[kSpeed] * (frame * plate.segment<3>(kBend)) + turn;
  r[18] = x.y();
  return r;
}

/// The thread's fields at the ends of the intervals, then frequency and length.
class Thread {
 public:
  Thread() : values_(Eigen::VectorXd::Zero(kFields * (kIntervals + 1) + 2)) { guess(); }

  Fields at(int k) const { return values_.segment<kFields>(kFields * k); }
  double frequency() const { return values_[values_.size() - 2]; }
  double length() const { return values_[values_.size() - 1]; }

  /// Newton's method; returns whether it converged.
  bool solve(const Numbers& numbers) {
    for (int k = 0; k < kMostIterations; ++k) {
      const Eigen::VectorXd r = residual(values_, numbers);
      if (!r.allFinite()) return false;
      if (r.norm() < kConverged) return true;
      const Eigen::SparseMatrix<double> matrix = jacobian(numbers);
      Eigen::SparseLU<Eigen::SparseMatrix<double>> factors(matrix);
      if (factors.info() != Eigen::Success) return false;
      step_along(factors.solve(-r), r.norm(), numbers);
    }
    return false;
  }

 private:
  /// Straight down at the mouth, level at the plate, kGuessedRadius beside the axis there.
  void guess();

  static Fields interval(const Eigen::VectorXd& values, int k, const Numbers& numbers) {
    const Fields a = values.segment<kFields>(kFields * k), b = values.segment<kFields>(kFields * (k + 1));
    return interval(a, b, values[values.size() - 2], values[values.size() - 1], numbers);
  }
  static Fields interval(const Fields& a, const Fields& b, double frequency, double length,
                         const Numbers& numbers) {
    return b - a - length / kIntervals * derivative((a + b) / 2, frequency, numbers);
  }
  static Eigen::VectorXd residual(const Eigen::VectorXd& values, const Numbers& numbers) {
    Eigen::VectorXd r(values.size());
    for (int k = 0; k < kIntervals; ++k) r.segment<kFields>(kFields * k) = interval(values, k, numbers);
    r.tail<kUnknowns>() = ends(values.head<kFields>(), values.segment<kFields>(kFields * kIntervals),
                               values[values.size() - 2]);
    return r;
  }

  /// The whole step, or the largest of its halves that brings the residual down.
  void step_along(const Eigen::VectorXd& step, double norm, const Numbers& numbers) {
    double share = 1;
    for (int half = 0; half < 12; ++half, share /= 2)
      if (const double next = residual(values_ + share * step, numbers).norm(); next < norm) break;
    values_ += share * step;
  }

  Eigen::SparseMatrix<double> jacobian(const Numbers& numbers) const;

  Eigen::VectorXd values_;
};

void Thread::guess() {
  const double radius = kGuessedRadius;
  std::vector<Vec3> x, tangent;
  double length = 0;
  for (int k = 0; k <= kIntervals; ++k) {
    const double t = static_cast<double>(k) / kIntervals;
    x.emplace_back(radius * t * t * (3 - 2 * t), 1.6 * radius * t * t * (1 - t),
                   -std::sin(std::numbers::pi / 2 * t));
    const Vec3 rate(radius * 6 * t * (1 - t), 1.6 * radius * (2 * t - 3 * t * t),
                    -std::numbers::pi / 2 * std::cos(std::numbers::pi / 2 * t));
    tangent.push_back(rate.normalized());
    length += rate.norm() / kIntervals;
  }
  Eigen::Quaterniond q(0, 1, 0, 0);
  for (int k = 0; k <= kIntervals; ++k) {
    const auto a = static_cast<std::size_t>(std::max(k - 1, 0)), b = static_cast<std::size_t>(k);
    const auto c = static_cast<std::size_t>(std::min(k + 1, kIntervals));
    q = Eigen::Quaterniond::FromTwoVectors(tangent[a], tangent[b]) * q;
    const Vec3 bend =
        tangent[b].cross(tangent[c] - tangent[a]) * (kIntervals / length / static_cast<double>(c - a));
    Fields y = Fields::Zero();
    y.segment<3>(kPlace) = x[b];
    y.segment<4>(kFrame) = Eigen::Vector4d(q.w(), q.x(), q.y(), q.z());
    y[kSpeed] = 1;
    y.segment<3>(kBend) = q.conjugate() * bend;
    values_.segment<kFields>(kFields * k) = y;
  }
  values_.tail<2>() = Vec2(1 / radius, length);
}

Eigen::SparseMatrix<double> Thread::jacobian(const Numbers& numbers) const {
  const int parameters = kFields * (kIntervals + 1);
  std::vector<Eigen::Triplet<double>> entries;
  const auto put = [&](int row, int column, const auto& change) {
    for (int r = 0; r < change.size(); ++r)
      if (change[r] != 0) entries.emplace_back(row + r, column, change[r] / kNudge);
  };
  for (int k = 0; k < kIntervals; ++k) {
    const Fields a = at(k), b = at(k + 1), here = interval(a, b, frequency(), length(), numbers);
    for (int c = 0; c < kFields; ++c) {
      const Fields nudge = kNudge * Fields::Unit(c);
      put(kFields * k, kFields * k + c, interval(a + nudge, b, frequency(), length(), numbers) - here);
      put(kFields * k, kFields * (k + 1) + c, interval(a, b + nudge, frequency(), length(), numbers) - here);
    }
    put(kFields * k, parameters, interval(a, b, frequency() + kNudge, length(), numbers) - here);
    put(kFields * k, parameters + 1, interval(a, b, frequency(), length() + kNudge, numbers) - here);
  }
  const Fields mouth = at(0), plate = at(kIntervals);
  const auto here = ends(mouth, plate, frequency());
  const int last = kFields * kIntervals;
  for (int c = 0; c < kFields; ++c) {
    const Fields nudge = kNudge * Fields::Unit(c);
    put(last, c, ends(mouth + nudge, plate, frequency()) - here);
    put(last, last + c, ends(mouth, plate + nudge, frequency()) - here);
  }
  put(last, parameters, ends(mouth, plate, frequency() + kNudge) - here);
  Eigen::SparseMatrix<double> matrix(values_.size(), values_.size());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

SteadyCoil steady_coil(const FallingThread& thread) {
  const double height = thread.height;
  const double slenderness = std::pow(thread.radius / height, 2) / 4;
  const double inertia = thread.speed * height / (3 * thread.viscosity);
  const double gravity = thread.gravity * height * height / (3 * thread.viscosity * thread.speed);
  Thread shape;
  for (const double share : std::array{0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0})
    if (!shape.solve({slenderness, share * inertia, share * gravity}))
      throw InvalidInput("the slender thread's equations have no single solution for these numbers");
  const double speed = shape.at(kIntervals)[kSpeed];
  return {shape.frequency() * thread.speed / height, speed / shape.frequency() * height,
          thread.radius / std::sqrt(speed)};
}

}  // namespace kappaflow
