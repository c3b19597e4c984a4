#include "solver/rigid_balance.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "core/parallel.h"
#include "solver/halo.h"

namespace kappaflow {
namespace {

using rigid::Matrix6;
using rigid::Vector6;
using rigid::velocities_at;

// Of a particle [spacing^2], so that one alone, or a line of them, has an inverse; too small to matter.
constexpr double kLeastInertia = 1e-9;
constexpr std::size_t kBalanceGrain = 4;  // cells that a task works on

Vec3 in_double(const Vec4f& v) {
  return v.head<3>().cast<double>();
}

/// The balance K q = missing about a point.
struct Balance {
  // Of the particles' inertia: their masses, and the sums of mass arm and of mass arm arm^T.
  double mass = 0;
  Vec3 moment = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  Matrix6 resistance = Matrix6::Zero();  // of what is not liquid
  Vector6 missing = Vector6::Zero();

  friend Balance operator+(Balance a, const Balance& b) {
    a.mass += b.mass;
    a.moment += b.moment;
    a.second += b.second;
    a.resistance += b.resistance;
    a.missing += b.missing;
    return a;
  }

  /// Adds a particle's inertia; velocity: what it lacks of its own.
  void add_inertia(double of_particle, const Vec3& velocity, const Vec3& arm) {
    mass += of_particle;
    moment += of_particle * arm;
    second += of_particle * arm * arm.transpose();
    const Vec3 left = of_particle * velocity;
    missing.head<3>() += left;
    missing.tail<3>() += arm.cross(left);
  }
  /// Adds a resistance m (v - v_0) of which `left` is what is left of it.
  void add_resistance(const Mat3& m, const Vec3& left, const Vec3& arm) {
    const auto b = velocities_at(arm);
    resistance += b.transpose() * m * b;
    missing += b.transpose() * left;
  }

  /// q, each particle having this moment of inertia over its mass of its own.
  Vector6 solve(double inertia) const {
    Matrix6 matrix = resistance;
    const Mat3 turning = second.trace() * Mat3::Identity() - second;
    matrix.topLeftCorner<3, 3>() += mass * Mat3::Identity();
    matrix.topRightCorner<3, 3>() += velocities_at(moment).rightCols<3>();
    matrix.bottomLeftCorner<3, 3>() += velocities_at(moment).rightCols<3>().transpose();
    matrix.bottomRightCorner<3, 3>() += turning + mass * inertia * Mat3::Identity();
    return matrix.ldlt().solve(missing);
  }
};

/// Of one particle, by itself: its inertia, its walls, and the particles beside it that are led.
class ParticleBalance {
 public:
  ParticleBalance(const ViscousForces& forces, const FluidParticles& particles, const NeighbourLists& lists,
                  const WallSums& walls, float time_step, const std::vector<Vec4f>& v)
      : forces_(forces), particles_(particles), lists_(lists), walls_(walls), time_step_(time_step), v_(v) {}

  void add_to(Balance& balance, std::size_t i, const Vec3& arm) const {
    balance.add_inertia(static_cast<double>(particles_.mass(i)),
                        in_double(particles_.velocity[i]) - in_double(v_[i]), arm);
    if (!walls_.touches(i)) return;
    Mat3 m;
    for (int c = 0; c < 3; ++c)
      m.col(c) = in_double(time_step_ * forces_.wall_drag(i, particles_, walls_, Vec4f::Unit(c)));
    const Vec4f drag =
        forces_.wall_drive(i, particles_, walls_) - forces_.wall_drag(i, particles_, walls_, v_[i]);
    balance.add_resistance(m, in_double(time_step_ * drag), arm);
  }

  void add_led(Balance& balance, std::size_t i, const Vec3& arm) const {
    forces_.for_pairs(i, particles_, lists_,
                      [&](const PairBlock& block, const WideVec& x, const Wide& w, const WideVec&) {
                        for (int k = 0; k < kWide; ++k) {
                          const std::size_t j = block.base + block.offset[static_cast<std::size_t>(k)];
                          if (!(w[k] > 0) || particles_.led_by[j] == 0) continue;
                          const Vec3 line(static_cast<double>(x.x[k]), static_cast<double>(x.y[k]),
                                          static_cast<double>(x.z[k]));
                          const Mat3 m = static_cast<double>(time_step_ * w[k]) * line * line.transpose();
                          balance.add_resistance(m, m * (in_double(v_[j]) - in_double(v_[i])), arm);
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

/// Calls work(cells) for the cells of each component, which follow each other in `order`.
template <class Work>
void for_components(std::span<const std::uint32_t> order, std::span<const std::uint32_t> component,
                    const Work& work) {
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && component[order[end]] == component[order[begin]]) ++end;
    work(order.subspan(begin, end - begin));
  }
}

/// Each component's balance of the particles of all ranks; few components reach over more than one.
void sum_over_ranks(std::vector<Balance>& balances, Ranks& ranks) {
  struct Part {
    std::size_t component;
    Balance balance;
  };
  std::vector<Part> parts;
  for (std::size_t k = 0; k < balances.size(); ++k)
    if (balances[k].mass > 0) parts.push_back({k, balances[k]});
  std::ranges::fill(balances, Balance());
  for (const Part& part : ranks.gathered(parts))
    balances[part.component] = balances[part.component] + part.balance;
}

}  // namespace

/// Liquid that touches the same body becomes one component.
void MomentumBalance::connect_by_bodies(const RigidMultigrid& multigrid, const ViscousForces& forces,
                                        const FluidParticles& particles, const BodyDrag& bodies) {
  component_of_body_.assign(bodies.bodies(), RigidLevel::kNone);
  if (bodies.bodies() == 0) return;
  cell_.resize(particles.size());
  multigrid.for_cells([&](std::size_t cell) {
    multigrid.for_particles(cell, [&](std::size_t i) { cell_[i] = static_cast<std::uint32_t>(cell); });
  });
  // What a component has become, by its first cell.
  std::vector<std::uint32_t> now(component_.size());
  std::iota(now.begin(), now.end(), 0u);
  const auto root = [&](std::uint32_t c) {
    while (now[c] != c) c = now[c];
    return c;
  };
  struct Touch {
    std::uint32_t body, component;
    bool operator==(const Touch&) const = default;
  };
  std::vector<Touch> touches;
  for (std::uint32_t b = 0; b < bodies.bodies(); ++b)
    for (const BodyContact& contact : bodies.contacts(b)) {
      if (!forces.act_on(contact.particle, particles)) continue;
      const Touch touch{b, component_[cell_[contact.particle]]};
      if (touches.empty() || touches.back() != touch) touches.push_back(touch);
    }
  if (particles.halo != nullptr) touches = particles.halo->ranks().gathered(touches);
  for (const Touch& touch : touches) {
    const std::uint32_t other = root(touch.component);
    std::uint32_t& own = component_of_body_[touch.body];
    own = own == RigidLevel::kNone ? other : root(own);
    now[std::max(own, other)] = own = std::min(own, other);
  }
  for (std::uint32_t& component : component_) component = root(component);
  for (std::uint32_t& component : component_of_body_)
    if (component != RigidLevel::kNone) component = root(component);
}

void MomentumBalance::restore(RigidMultigrid& multigrid, const ViscousForces& forces,
                              const FluidParticles& particles, const NeighbourLists& lists,
                              const WallSums& walls, const BodyDrag& bodies, float time_step,
                              std::vector<Vec4f>& v) {
  const ParticleBalance particle(forces, particles, lists, walls, time_step, v);
  const double inertia = kLeastInertia * multigrid.spacing() * multigrid.spacing();
  multigrid.find_components(component_);
  connect_by_bodies(multigrid, forces, particles, bodies);
  order_.resize(component_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  std::ranges::sort(order_, {}, [this](std::uint32_t cell) { return std::pair(component_[cell], cell); });
  if (multigrid.any_led()) fill_ghosts(particles, v);
  const auto centre_of = [&](std::span<const std::uint32_t> cells) -> Vec3 {
    return in_double(multigrid.finest().centre[cells.front()]);
  };
  const auto find_balance = [&](std::span<const std::uint32_t> cells) {
    const Vec3 centre = centre_of(cells);
    const auto balance_of = [&](std::size_t k) {
      Balance sum;
      multigrid.for_particles(cells[k], [&](std::size_t i) {
        const Vec3 arm = in_double(particles.position[i]) - centre;
        particle.add_to(sum, i, arm);
        if (multigrid.any_led()) particle.add_led(sum, i, arm);
      });
      return sum;
    };
    return parallel_sum(cells.size(), Balance(), balance_of, kBalanceGrain);
  };
  const auto correct = [&](std::span<const std::uint32_t> cells, Balance balance) {
    const Vec3 centre = centre_of(cells);
    for (std::size_t b = 0; b < bodies.bodies(); ++b)
      if (component_of_body_[b] == component_[cells.front()])
        balance.resistance -= bodies.yielding(b, centre);
    const Vector6 q = balance.solve(inertia);
    const auto correct_in_cell = [&](std::size_t k) {
      multigrid.for_particles(cells[k], [&](std::size_t i) {
        v[i] += padded(q.head<3>() + q.tail<3>().cross(in_double(particles.position[i]) - centre));
      });
    };
    parallel_for(cells.size(), correct_in_cell, kBalanceGrain);
  };
  if (particles.halo == nullptr) {
    for_components(order_, component_, [&](const auto& cells) { correct(cells, find_balance(cells)); });
    return;
  }
  std::vector<Balance> balances;
  for_components(order_, component_, [&](const auto& cells) { balances.push_back(find_balance(cells)); });
  sum_over_ranks(balances, particles.halo->ranks());
  auto balance = balances.begin();
  for_components(order_, component_, [&](const auto& cells) { correct(cells, *balance++); });
}

}  // namespace kappaflow
