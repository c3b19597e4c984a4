#include "solver/rigid_balance.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "core/parallel.h"

namespace kappaflow {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr std::size_t kBalanceGrain = 4;  // cells that a task works on
// Of a particle [spacing^2], so that one alone, or a line of them, has an inverse; too small to matter.
constexpr double kLeastInertia = 1e-9;

/// B of a particle.
Eigen::Matrix<double, 3, 6> rigid_velocities(const Vec3& arm) {
  Eigen::Matrix<double, 3, 6> result;
  result << 1, 0, 0, 0, arm.z(), -arm.y(),  //
      0, 1, 0, -arm.z(), 0, arm.x(),        //
      0, 0, 1, arm.y(), -arm.x(), 0;
  return result;
}

/// The balance K q = missing of a cell or a component about a point.
struct Balance {
  Matrix6 matrix = Matrix6::Zero();
  Vector6 missing = Vector6::Zero();

  /// Adds a resistance m (v - v_0) of which `missing` is what is left of it.
  void add(const Eigen::Matrix3d& m, const Vec3& left, const Vec3& arm) {
    const auto b = rigid_velocities(arm);
    matrix += b.transpose() * m * b;
    missing += b.transpose() * left;
  }
  /// Adds another about the point at `arm`.
  void add(const Balance& other, const Vec3& arm) {
    Matrix6 shift = Matrix6::Identity();
    shift.topRows<3>() = rigid_velocities(arm);
    matrix += shift.transpose() * other.matrix * shift;
    missing += shift.transpose() * other.missing;
  }
};

Vec3 in_double(const Vec4f& v) {
  return v.head<3>().cast<double>();
}

}  // namespace

/// Of one particle, by itself: its inertia, its walls, and the particles beside it that are led.
class ParticleBalance {
 public:
  ParticleBalance(const ViscousForces& forces, const FluidParticles& particles, const NeighbourLists& lists,
                  const WallSums& walls, float time_step, const std::vector<Vec4f>& v)
      : forces_(forces), particles_(particles), lists_(lists), walls_(walls), time_step_(time_step), v_(v) {}

  void add_to(Balance& balance, std::size_t i, const Vec3& arm) const {
    Eigen::Matrix3d m = Eigen::Matrix3d::Identity();
    Vec3 left = in_double(particles_.velocity[i]) - in_double(v_[i]);
    if (walls_.touches(i)) {
      for (int c = 0; c < 3; ++c)
        m.col(c) += in_double(time_step_ * forces_.wall_drag(i, particles_, walls_, Vec4f::Unit(c)));
      const Vec4f drag =
          forces_.wall_drive(i, particles_, walls_) - forces_.wall_drag(i, particles_, walls_, v_[i]);
      left += in_double(time_step_ * drag);
    }
    balance.add(m, left, arm);
  }

  void add_led(Balance& balance, std::size_t i, const Vec3& arm) const {
    forces_.for_pairs(i, particles_, lists_, [&](const PairBlock& block, const WideVec& x, const Wide& w) {
      for (int k = 0; k < kWide; ++k) {
        const std::size_t j = block.base + block.offset[static_cast<std::size_t>(k)];
        if (!(w[k] > 0) || particles_.led_by[j] == 0) continue;
        const Vec3 line(static_cast<double>(x.x[k]), static_cast<double>(x.y[k]),
                        static_cast<double>(x.z[k]));
        const Eigen::Matrix3d m = static_cast<double>(time_step_ * w[k]) * line * line.transpose();
        balance.add(m, m * (in_double(v_[j]) - in_double(v_[i])), arm);
      }
    });
  }

 private:
  const ViscousForces& forces_;
  const FluidParticles& particles_;
  const NeighbourLists& lists_;
  const WallSums& walls_;
  float time_step_;
  const std::vector<Vec4f>& v_;
};

void balance_momentum(const RigidMultigrid& multigrid, const ViscousForces& forces,
                      const FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
                      float time_step, std::vector<Vec4f>& v) {
  const RigidLevel& cells = multigrid.finest();
  const ParticleBalance particle(forces, particles, lists, walls, time_step, v);
  std::vector<Balance> of(cells.cells());
  parallel_for(
      of.size(),
      [&](std::size_t cell) {
        multigrid.for_particles(cell, [&](std::size_t i) {
          const Vec3 arm = in_double(particles.position[i]) - in_double(cells.centre[cell]);
          particle.add_to(of[cell], i, arm);
          if (multigrid.any_led()) particle.add_led(of[cell], i, arm);
        });
        of[cell].matrix.diagonal().tail<3>().array() += kLeastInertia * multigrid.spacing() *
                                                        multigrid.spacing() *
                                                        static_cast<double>(cells.centre[cell][3]);
      },
      kBalanceGrain);
  // About the centre of the component's first cell.
  const std::vector<std::uint32_t> component = multigrid.components();
  const auto arm_of = [&](std::size_t cell) -> Vec3 {
    return in_double(cells.centre[cell]) - in_double(cells.centre[component[cell]]);
  };
  for (std::size_t cell = 0; cell < of.size(); ++cell)
    if (component[cell] != cell) of[component[cell]].add(of[cell], arm_of(cell));
  parallel_for(of.size(), [&](std::size_t cell) {
    if (component[cell] == cell) of[cell].missing = of[cell].matrix.ldlt().solve(of[cell].missing);
  });
  parallel_for(
      of.size(),
      [&](std::size_t cell) {
        const Vector6& q = of[component[cell]].missing;
        multigrid.for_particles(cell, [&](std::size_t i) {
          const Vec3 arm = in_double(particles.position[i]) - in_double(cells.centre[component[cell]]);
          v[i] += padded(rigid_velocities(arm) * q);
        });
      },
      kBalanceGrain);
}

}  // namespace kappaflow
