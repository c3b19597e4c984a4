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

/// Of the particles of one component's cells about a point.
class ComponentBalance {
 public:
  ComponentBalance(const RigidMultigrid& multigrid, const FluidParticles& particles,
                   const ParticleBalance& particle)
      : multigrid_(multigrid), particles_(particles), particle_(particle) {}

  Balance find(std::span<const std::uint32_t> cells, const Vec3& centre) const {
    const auto balance_of = [&](std::size_t k) {
      Balance sum;
      multigrid_.for_particles(cells[k], [&](std::size_t i) {
        const Vec3 arm = in_double(particles_.position[i]) - centre;
        particle_.add_to(sum, i, arm);
        if (multigrid_.any_led()) particle_.add_led(sum, i, arm);
      });
      return sum;
    };
    return parallel_sum(cells.size(), Balance(), balance_of, kBalanceGrain);
  }

  /// Adds q.
  void correct(std::span<const std::uint32_t> cells, const Vec3& centre, const Balance& balance,
               std::vector<Vec4f>& v) const {
    const Vector6 q = balance.solve(kLeastInertia * multigrid_.spacing() * multigrid_.spacing());
    const auto correct_in_cell = [&](std::size_t k) {
      multigrid_.for_particles(cells[k], [&](std::size_t i) {
        v[i] += padded(q.head<3>() + q.tail<3>().cross(in_double(particles_.position[i]) - centre));
      });
    };
    parallel_for(cells.size(), correct_in_cell, kBalanceGrain);
  }

 private:
  const RigidMultigrid& multigrid_;
  const FluidParticles& particles_;
  const ParticleBalance& particle_;
};

/// Calls work(cells) for the cells of each component, which follow each other in `order`.
template <class Work>
void for_components(std::span<const std::uint32_t> order, std::span<const std::uint64_t> component,
                    const Work& work) {
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && component[order[end]] == component[order[begin]]) ++end;
    work(order.subspan(begin, end - begin));
  }
}

/// A component that several ranks may have parts of: the balance of this one's.
struct JointBalance {
  std::uint64_t component = 0;
  Balance balance;
};

/// From each rank's parts, by ascending components, to the balances of their components.
void sum_over_ranks(std::vector<JointBalance>& parts, Ranks& ranks) {
  const std::vector<JointBalance> all = ranks.gathered(parts);
  for (JointBalance& part : parts) part.balance = Balance();
  for (const JointBalance& part : all) {
    const auto own = std::ranges::lower_bound(parts, part.component, {}, &JointBalance::component);
    if (own != parts.end() && own->component == part.component) own->balance = own->balance + part.balance;
  }
}

/// Beyond all keys of cells.
constexpr std::uint64_t label_of_body(std::size_t body) {
  return (std::uint64_t{1} << 63) + body;
}

/// The sets that joints make of components, each known by its least.
class JoinedSets {
 public:
  template <class Joints>
  explicit JoinedSets(const Joints& joints) {
    for (const auto& joint : joints) labels_.insert(labels_.end(), {joint.a, joint.b});
    std::ranges::sort(labels_);
    labels_.erase(std::unique(labels_.begin(), labels_.end()), labels_.end());
    above_.resize(labels_.size());
    std::iota(above_.begin(), above_.end(), std::size_t{0});
    for (const auto& joint : joints) {
      const std::size_t a = root(place_of(joint.a)), b = root(place_of(joint.b));
      above_[std::max(a, b)] = std::min(a, b);
    }
    for (std::size_t k = 0; k < above_.size(); ++k) above_[k] = above_[above_[k]];
  }

  /// Itself if no joint has it.
  std::uint64_t least_of_set(std::uint64_t component) const {
    const std::size_t k = place_of(component);
    return k < labels_.size() && labels_[k] == component ? labels_[above_[k]] : component;
  }
  /// The least of each set, ascending.
  std::vector<std::uint64_t> sets() const {
    std::vector<std::uint64_t> result;
    for (std::size_t k = 0; k < labels_.size(); ++k)
      if (above_[k] == k) result.push_back(labels_[k]);
    return result;
  }

 private:
  std::size_t place_of(std::uint64_t component) const {
    return static_cast<std::size_t>(std::ranges::lower_bound(labels_, component) - labels_.begin());
  }
  std::size_t root(std::size_t k) {
    while (above_[k] != k) k = above_[k] = above_[above_[k]];
    return k;
  }

  std::vector<std::uint64_t> labels_;  // ascending
  std::vector<std::size_t> above_;     // of each a lesser one of its set, or itself
};

}  // namespace

/// Connected liquid of several ranks, and all that touches the same body, becomes one component.
void MomentumBalance::join(RigidMultigrid& multigrid, const ViscousForces& forces,
                           const FluidParticles& particles, const BodyDrag& bodies) {
  std::vector<Joint> joints;
  join_by_bodies(multigrid, forces, particles, bodies, joints);
  if (particles.halo != nullptr) join_over_borders(multigrid, joints);
  std::ranges::sort(joints);
  joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
  if (particles.halo != nullptr) joints = particles.halo->ranks().gathered(joints);
  const JoinedSets sets(joints);
  joined_ = sets.sets();
  parallel_for(component_.size(),
               [&](std::size_t cell) { component_[cell] = sets.least_of_set(component_[cell]); });
  component_of_body_.resize(bodies.bodies());
  for (std::size_t b = 0; b < bodies.bodies(); ++b)
    component_of_body_[b] = sets.least_of_set(label_of_body(b));
}

/// A link over a border is one that both ranks know. Each says what the component is called there.
void MomentumBalance::join_over_borders(RigidMultigrid& multigrid, std::vector<Joint>& joints) {
  const RigidLevel& level = multigrid.finest();
  std::vector<std::uint64_t> elsewhere = component_;
  multigrid.share_values(elsewhere);
  for (std::size_t k = 0; k < level.links.size(); ++k) {
    const auto [from, to] = level.links[k];
    if (level.is_own(from) == level.is_own(to) || !multigrid.is_connected(k)) continue;
    joints.push_back({component_[from], elsewhere[level.is_own(from) ? to : from]});
  }
}

void MomentumBalance::join_by_bodies(const RigidMultigrid& multigrid, const ViscousForces& forces,
                                     const FluidParticles& particles, const BodyDrag& bodies,
                                     std::vector<Joint>& joints) {
  if (bodies.bodies() == 0) return;
  cell_.resize(particles.size());
  multigrid.for_cells([&](std::size_t cell) {
    multigrid.for_particles(cell, [&](std::size_t i) { cell_[i] = static_cast<std::uint32_t>(cell); });
  });
  for (std::size_t b = 0; b < bodies.bodies(); ++b)
    for (const BodyContact& contact : bodies.contacts(b)) {
      if (!forces.act_on(contact.particle, particles)) continue;
      const Joint joint{component_[cell_[contact.particle]], label_of_body(b)};
      if (joints.empty() || joints.back() != joint) joints.push_back(joint);
    }
}

/// Fills order_.
void MomentumBalance::sort_cells(const RigidLevel& level) {
  order_.clear();
  for (std::uint32_t cell = 0; cell < component_.size(); ++cell)
    if (level.is_own(cell)) order_.push_back(cell);
  std::ranges::sort(order_, {}, [this](std::uint32_t cell) { return std::pair(component_[cell], cell); });
}

void MomentumBalance::restore(RigidMultigrid& multigrid, const ViscousForces& forces,
                              const FluidParticles& particles, const NeighbourLists& lists,
                              const WallSums& walls, const BodyDrag& bodies, float time_step,
                              std::vector<Vec4f>& v) {
  multigrid.find_components(component_);
  join(multigrid, forces, particles, bodies);
  sort_cells(multigrid.finest());
  if (multigrid.any_led()) fill_ghosts(particles, v);
  std::vector<Matrix6> yielding(bodies.bodies(), Matrix6::Zero());
  for (std::size_t b = 0; b < bodies.bodies(); ++b)
    if (component_of_body_[b] != label_of_body(b))
      yielding[b] = bodies.yielding(b, multigrid.point_of(component_of_body_[b]));

  const ParticleBalance particle(forces, particles, lists, walls, time_step, v);
  const ComponentBalance of_component(multigrid, particles, particle);
  const auto correct = [&](std::span<const std::uint32_t> cells, Balance balance) {
    const std::uint64_t component = component_[cells.front()];
    for (std::size_t b = 0; b < bodies.bodies(); ++b)
      if (component_of_body_[b] == component) balance.resistance -= yielding[b];
    of_component.correct(cells, multigrid.point_of(component), balance, v);
  };
  // Of components that are this rank's alone no other needs to know.
  std::vector<std::span<const std::uint32_t>> joint;
  std::vector<JointBalance> balances;
  for_components(order_, component_, [&](std::span<const std::uint32_t> cells) {
    const std::uint64_t component = component_[cells.front()];
    const Balance own = of_component.find(cells, multigrid.point_of(component));
    if (particles.halo == nullptr || !std::ranges::binary_search(joined_, component))
      return correct(cells, own);
    joint.push_back(cells);
    balances.push_back({component, own});
  });
  if (particles.halo != nullptr) sum_over_ranks(balances, particles.halo->ranks());
  for (std::size_t k = 0; k < joint.size(); ++k) correct(joint[k], balances[k].balance);
}

}  // namespace kappaflow
