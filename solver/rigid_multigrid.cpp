#include "solver/rigid_multigrid.h"

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "solver/halo.h"

namespace kappaflow {
namespace {

constexpr float kLastCell = (1 << RigidLevel::kBitsOfPlace) - 1;
// Particles are points: a cell with one of them, or with a line of them, could turn at no cost, and has no
// inverse. In `inverse` each has this moment of inertia [spacing^2].
constexpr double kPointInertia = 0.01;
// Of nu dt / spacing^2: below it D^-1 alone takes no more iterations.
constexpr double kWeak = 0.2;
// Of the 3x3 blocks, see kUncertainty of rigid_level.cpp.
constexpr double kBlockUncertainty = 1e-6;

/// Particles' cells along one axis; those too far away for a key share the last.
float cell_along(float x, float lower, float width) {
  return std::min(std::floor((x - lower) * (1 / width)), kLastCell);
}

/// w x x^T of eight pairs.
using WideSquares = std::array<Wide, 6>;

/// By side, of each octant: itself where its cell comes after the particle's, whose links are to those alone,
/// else 0. What is beyond on the last axis decides.
constexpr auto kCounted = [] {
  std::array<std::array<std::int32_t, 8>, 8> counted{};
  for (unsigned side = 0; side < 8; ++side)
    for (unsigned octant = 1; octant < 8; ++octant)
      if ((side & std::bit_floor(octant)) != 0) counted[side][octant] = static_cast<std::int32_t>(octant);
  return counted;
}();

WideSquares weighted_squares(const WideVec& x, const Wide& weight) {
  const Wide wx = weight * x.x, wy = weight * x.y, wz = weight * x.z;
  return {wx * x.x, wy * x.y, wz * x.z, wy * x.z, wx * x.z, wx * x.y};
}

}  // namespace

RigidMultigrid::RigidMultigrid(double spacing) : spacing_(spacing), levels_(1) {}

std::size_t RigidMultigrid::bytes() const {
  std::size_t sum = bytes_of(runs_, first_run_, inverse_diagonal_, root_);
  for (const RigidLevel& level : levels_) sum += level.bytes();
  return sum;
}

/// Sums over the pairs of a cell's particles. With T the sum of w x x^T over some pairs of a particle, that
/// of w l l^T, l = (x, arm x x) the load of a unit force along the pair, is T's rigid::matrix_at() the
/// particle's arm.
///
/// The cell is wider than twice the kernel's support: on each axis a particle has neighbours in its own cell
/// and, in the cell's upper half, in the one above, else in the one below. So there are eight cells that they
/// can be in, which are counted by octant: bit a is set beyond the cell's border on axis a. Which eight:
/// by the particle's side, bit a set in the upper half on axis a.
class RigidMultigrid::CellSums {
 public:
  CellSums(RigidMultigrid& grid, std::size_t cell, const ViscousForces& forces,
           const FluidParticles& particles, const NeighbourLists& lists, const WallSums& walls,
           float time_step)
      : grid_(grid),
        forces_(forces),
        particles_(particles),
        lists_(lists),
        walls_(walls),
        time_step_(time_step),
        inverse_width_(1 / static_cast<float>(kCellWidth * grid.spacing_)),
        cell_(cell) {
    const auto place = RigidLevel::place_of(grid.finest().key[cell]);
    for (std::size_t a = 0; a < 3; ++a) place_[a] = static_cast<float>(place[a] + grid.first_place_[a]);
  }

  /// Returns (L v)_i.
  Vec4f add(std::size_t i, const std::vector<Vec4f>& v) {
    const bool carried = !grid_.weak_ && grid_.is_carried(i, particles_);
    if (carried) find_borders(particles_.position[i]);
    std::array<Wide, 6> pairs;
    pairs.fill(Wide::Zero());
    PairResistance resistance(i, v);
    forces_.for_pairs(
        i, particles_, lists_,
        [&](const PairBlock& block, const WideVec& x, const Wide& w, const WideVec& xj)
            __attribute__((always_inline)) {
              resistance.add(block, x, w);
              const WideSquares squares = weighted_squares(x, w);
              for (std::size_t k = 0; k < 6; ++k) pairs[k] += squares[k];
              if (carried) couple(block, xj, w, squares);
            });
    const SymmetricMatrix drag = wall_drag(i);
    const Vec4f diagonal = sums(pairs[0], pairs[1], pairs[2]), others = sums(pairs[3], pairs[4], pairs[5]);
    grid_.inverse_diagonal_[i] =
        inverse_of(particles_.mass(i), {diagonal[0] + drag[0], diagonal[1] + drag[1], diagonal[2] + drag[2],
                                        others[0] + drag[3], others[1] + drag[4], others[2] + drag[5]});
    if (carried) add_squares(i, drag);
    return resistance.sum() + forces_.wall_drag(i, particles_, walls_, v[i]);
  }

  /// Writes what has been added.
  void finish() const;

 private:
  static constexpr int kApart = 8;  // in place of the octant: a particle that no cell carries
  // Sums that the pairs of a block are added to in turn: none waits for the one before.
  static constexpr std::size_t kChains = 2;
  using Octants = std::array<std::int32_t, kWide>;

  void find_borders(const Vec4f& x);
  /// Notes those of the pairs that are between two cells, or with a particle that no cell carries.
  [[gnu::always_inline]] void couple(const PairBlock& block, const WideVec& xj, const Wide& weight,
                                     const WideSquares& squares) {
    Octants octant = octants(xj);
    if (grid_.any_led_ || grid_.any_weak_) find_apart(block, weight, octant);
    if (std::ranges::all_of(octant, [](std::int32_t o) { return o == 0; })) return;
    std::array<Eight, 8> of_pairs{};
    for (std::size_t k = 0; k < 6; ++k) of_pairs[k] = eight_of(squares[k]);
    transpose(of_pairs);
    for (std::size_t k = 0; k < kWide; ++k)
      squares_[k % kChains][static_cast<std::size_t>(octant[k])] += of_pairs[k];
  }
  Octants octants(const WideVec& xj) const {
    EightInts counted;
    std::memcpy(&counted, kCounted[side_].data(), sizeof counted);
    const EightInts sum = permuted(counted, beyond(xj.x, 0) + beyond(xj.y, 1) + beyond(xj.z, 2));
    Octants result;
    std::memcpy(result.data(), &sum, sizeof sum);
    return result;
  }
  /// 2^axis beyond the border, else 0.
  EightInts beyond(const Wide& x, std::size_t axis) const {
    const Eight at = (eight_of(x) - grid_.lower_[static_cast<int>(axis)]) * inverse_width_;
    const auto& [border, above, below] = borders_[axis];
    return ((at >= border) & above) | ((at < border) & below);
  }
  void find_apart(const PairBlock& block, const Wide& weight, Octants& octant) const {
    for (std::size_t k = 0; k < kWide; ++k) {
      const std::size_t j = block.base + block.offset[k];
      if (weight[static_cast<int>(k)] > 0 && (particles_.led_by[j] != 0 || !grid_.is_carried(j, particles_)))
        octant[k] = kApart;
    }
  }
  void add_squares(std::size_t i, const SymmetricMatrix& drag);
  SymmetricMatrix wall_drag(std::size_t i) const;
  /// Of mass + time_step * pairs.
  SymmetricMatrix inverse_of(float mass, const SymmetricMatrix& pairs) const;

  RigidMultigrid& grid_;
  const ViscousForces& forces_;
  const FluidParticles& particles_;
  const NeighbourLists& lists_;
  const WallSums& walls_;
  float time_step_, inverse_width_;
  std::size_t cell_;
  std::array<float, 3> place_;  // of the cell
  RigidMatrix anchor_;
  bool empty_ = true;                                  // nothing is carried
  std::array<RigidMatrixOf<Wide>, 8> sums_ = zeros();  // by side, of the octants

  // Of one particle.
  struct Border {
    float at;                   // in widths of a cell
    std::int32_t above, below;  // what beyond() is on either side of it
  };
  std::array<Border, 3> borders_;
  std::size_t side_ = 0;
  /// By octant, 0 not to be counted, and of those apart.
  std::array<std::array<Eight, 9>, kChains> squares_;

  static std::array<RigidMatrixOf<Wide>, 8> zeros() {
    RigidMatrixOf<Wide> zero;
    zero.force.fill(Wide::Zero());
    zero.torque.fill(Wide::Zero());
    zero.turning.fill(Wide::Zero());
    std::array<RigidMatrixOf<Wide>, 8> result;
    result.fill(zero);
    return result;
  }
};

void RigidMultigrid::CellSums::find_borders(const Vec4f& x) {
  squares_ = {};
  side_ = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const int axis = static_cast<int>(a);
    const std::int32_t bit = 1 << a;
    const bool upper = (x[axis] - grid_.lower_[axis]) * inverse_width_ >= place_[a] + 0.5f;
    side_ |= static_cast<std::size_t>(upper) << a;
    borders_[a] = upper ? Border{place_[a] + 1, bit, 0} : Border{place_[a], 0, bit};
  }
}

/// Adds the particle's inertia, its walls' drag and what couple() has noted.
void RigidMultigrid::CellSums::add_squares(std::size_t i, const SymmetricMatrix& drag) {
  const Eigen::Vector3f arm = grid_.arm(cell_, particles_.position[i]).head<3>();
  const auto squares = [&](std::size_t octant) -> Eight { return squares_[0][octant] + squares_[1][octant]; };
  const Eight apart = squares(kApart);
  SymmetricMatrix own;
  const float mass = particles_.mass(i);
  for (std::size_t k = 0; k < 6; ++k) own[k] = (k < 3 ? mass : 0.0f) + time_step_ * (drag[k] + apart[k]);
  anchor_ += rigid::matrix_at(own, arm);
  std::array<Eight, 8> columns;
  for (std::size_t k = 0; k < 8; ++k) columns[k] = k == 0 ? Eight{} : time_step_ * squares(k);
  transpose(columns);
  WideSquares square;
  for (std::size_t k = 0; k < 6; ++k) square[k] = wide_of(columns[k]);
  empty_ = false;
  sums_[side_] += rigid::matrix_at(square, arm);
}

void RigidMultigrid::CellSums::finish() const {
  RigidLevel& level = grid_.levels_.front();
  level.anchor[cell_] =
      empty_ ? RigidMatrix{{1, 1, 1}} : anchor_;  // so that there is an inverse; its load is 0
  for (std::uint32_t k = level.first_link[cell_]; k < level.first_link[cell_ + 1]; ++k) {
    const auto other = RigidLevel::place_of(level.key[level.links[k].to]);
    RigidMatrix& sum = level.coupling[k] = RigidMatrix();
    // Beyond on the axes where the other cell has another place, and on that side.
    std::size_t octant = 0, above = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const float along = static_cast<float>(other[a] + grid_.first_place_[a]);
      octant |= static_cast<std::size_t>(along != place_[a]) << a;
      above |= static_cast<std::size_t>(along > place_[a]) << a;
    }
    for (std::size_t side = 0; side < 8; ++side)
      if ((side & octant) == above) sum += rigid::matrix_in(sums_[side], static_cast<int>(octant));
  }
}

SymmetricMatrix RigidMultigrid::CellSums::wall_drag(std::size_t i) const {
  if (!walls_.touches(i)) return {};
  const auto along = [&](int axis) { return forces_.wall_drag(i, particles_, walls_, Vec4f::Unit(axis)); };
  const Vec4f x = along(0), y = along(1), z = along(2);
  return {x[0], y[1], z[2], z[1], z[0], y[0]};
}

SymmetricMatrix RigidMultigrid::CellSums::inverse_of(float mass, const SymmetricMatrix& pairs) const {
  const double dt = static_cast<double>(time_step_);
  const auto [xx, yy, zz, yz, xz, xy] = pairs;
  Eigen::Matrix3f sum;
  sum << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  Eigen::Matrix3d block = static_cast<double>(mass) * Eigen::Matrix3d::Identity() + dt * sum.cast<double>();
  block.diagonal().array() += kBlockUncertainty * dt * static_cast<double>(xx + yy + zz);
  const Eigen::Matrix3f m = block.inverse().cast<float>();
  return {m(0, 0), m(1, 1), m(2, 2), m(1, 2), m(0, 2), m(0, 1)};
}

void RigidMultigrid::build(const ViscousForces& forces, const FluidParticles& particles,
                           const NeighbourLists& lists, const WallSums& walls, float time_step,
                           const std::vector<Vec4f>& v, std::vector<Vec4f>& resistance) {
  shared_ = particles.halo != nullptr;
  find_corner(particles);
  find_runs(forces, particles);
  find_cells(particles.halo);
  inverse_diagonal_.resize(particles.size());
  if (!weak_) levels_.front().make_room();
  for_cells([&](std::size_t cell) {
    if (finest().is_own(cell)) find_centre(particles, cell);
  });
  levels_.front().share_values(levels_.front().centre);
  for_cells([&](std::size_t cell) {
    if (!finest().is_own(cell)) return;
    CellSums sums(*this, cell, forces, particles, lists, walls, time_step);
    for_particles(cell, [&](std::size_t i) { resistance[i] = sums.add(i, v); });
    if (!weak_) sums.finish();
  });
  depth_ = 0;
  if (weak_) return;
  for (depth_ = 1;; ++depth_) {
    if (levels_.size() == depth_) levels_.emplace_back();
    if (!levels_[depth_].coarsen(levels_[depth_ - 1])) break;
  }
  for (std::size_t k = 0; k < depth_; ++k)
    levels_[k].invert(static_cast<float>(kPointInertia * spacing_ * spacing_));
}

void RigidMultigrid::find_weak(const ViscousForces& forces, float time_step) {
  weak_fluid_.resize(forces.fluids());
  for (std::size_t fluid = 0; fluid < forces.fluids(); ++fluid)
    weak_fluid_[fluid] =
        static_cast<double>(forces.kinematic_viscosity(fluid) * time_step) < kWeak * spacing_ * spacing_;
  const auto weak = std::ranges::count(weak_fluid_, 1);
  weak_ = weak == std::ssize(weak_fluid_);
  any_weak_ = weak > 0 && !weak_;
}

Vec3 RigidMultigrid::point_of(std::uint64_t key) const {
  if (!shared_) return finest().centre[finest().find(key)].head<3>().cast<double>();
  Vec3 point;
  const auto place = RigidLevel::place_of(key);
  for (std::size_t a = 0; a < 3; ++a)
    point[static_cast<int>(a)] =
        (static_cast<double>(place[a] + first_place_[a]) + 0.5) * kCellWidth * spacing_;
  return point;
}

bool RigidMultigrid::is_connected(std::size_t link) const {
  const auto [from, to] = finest().links[link];
  if (!finest().is_own(from) && !finest().is_own(to)) return false;
  return weak_ || any_weak_ || finest().is_coupled(link);
}

void RigidMultigrid::find_components(std::vector<std::uint64_t>& component) {
  finest().find_components(root_, [this](std::size_t link) { return is_connected(link); });
  component.resize(cells());
  parallel_for(cells(), [&](std::size_t cell) { component[cell] = finest().key[root_[cell]]; });
}

/// Where ranks share the liquid, cells are those by which it is cut, of a lattice that has no corner.
void RigidMultigrid::find_corner(const FluidParticles& particles) {
  const std::size_t n = particles.size();
  if (!shared_) {
    lower_ = parallel_reduce(
        n, Vec4f(particles.position.front()), [&](std::size_t i) -> Vec4f { return particles.position[i]; },
        [](const Vec4f& a, const Vec4f& b) -> Vec4f { return a.cwiseMin(b); });
    return;
  }
  using Place = LiquidCut::Place;
  Place last;
  last.fill(LiquidCut::kLargestPlace);
  const auto least = [](const Place& a, const Place& b) -> Place {
    return {std::min(a[0], b[0]), std::min(a[1], b[1]), std::min(a[2], b[2])};
  };
  const Place own = parallel_reduce(
      n, last, [&](std::size_t i) { return particles.halo->cut().place_of(particles.position[i]); }, least);
  first_place_ = particles.halo->ranks().combined(own, least);
}

void RigidMultigrid::find_runs(const ViscousForces& forces, const FluidParticles& particles) {
  const std::size_t n = particles.size();
  const float width = static_cast<float>(kCellWidth * spacing_);
  runs_.clear();
  any_led_ = false;
  bool in_run = false;
  for (std::uint32_t i = 0; i < n; ++i) {
    any_led_ = any_led_ || particles.led_by[i] != 0;
    const bool was_in_run = std::exchange(in_run, forces.act_on(i, particles));
    if (!in_run) continue;
    std::array<std::int64_t, 3> place;
    if (shared_) place = particles.halo->cut().place_of(particles.position[i]);
    for (std::size_t a = 0; a < 3; ++a)
      if (shared_)
        place[a] -= first_place_[a];
      else
        place[a] = static_cast<std::int64_t>(
            cell_along(particles.position[i][static_cast<int>(a)], lower_[static_cast<int>(a)], width));
    const std::uint64_t key = RigidLevel::key_of(place);
    if (!was_in_run || key != runs_.back().key) {
      if (runs_.size() == runs_.capacity())
        runs_.reserve(runs_.size() + runs_.size() / 8 + 64);  // not its double
      runs_.push_back({key, i, i});
    }
    runs_.back().end = i + 1;
  }
  any_led_ = max_of_ranks(particles, static_cast<int>(any_led_)) != 0;
}

void RigidMultigrid::find_cells(const Halo* halo) {
  std::ranges::sort(
      runs_, [](const Run& a, const Run& b) { return a.key != b.key ? a.key < b.key : a.begin < b.begin; });
  auto& keys = levels_.front().key;
  keys.clear();
  for (const Run& run : runs_)
    if (keys.empty() || run.key != keys.back()) keys.push_back(run.key);
  if (halo != nullptr) levels_.front().share_among(halo->ranks(), halo->cut(), first_place_);
  first_run_.resize(keys.size() + 1);
  std::uint32_t k = 0;
  for (std::size_t cell = 0; cell < keys.size(); ++cell) {
    first_run_[cell] = k;
    while (k < runs_.size() && runs_[k].key == keys[cell]) ++k;
  }
  first_run_.back() = k;
  levels_.front().reset();
}

void RigidMultigrid::find_centre(const FluidParticles& particles, std::size_t cell) {
  const Vec4f corner = particles.position[runs_[first_run_[cell]].begin];
  Vec4f sum = Vec4f::Zero();
  for_particles(cell, [&](std::size_t i) {
    const Vec4f arm = particles.position[i] - corner;
    sum += Vec4f(arm[0], arm[1], arm[2], 1);
  });
  levels_.front().centre[cell] = {corner[0] + sum[0] / sum[3], corner[1] + sum[1] / sum[3],
                                  corner[2] + sum[2] / sum[3], sum[3]};
}

double RigidMultigrid::restrict_to(std::size_t cell, const FluidParticles& particles,
                                   const std::vector<Vec4f>& r) {
  Vec4f force = Vec4f::Zero(), torque = force, energy = force;
  for_particles(cell, [&](std::size_t i) {
    energy += block_times(i, r[i]).cwiseProduct(r[i]);
    if (!is_carried(i, particles)) return;
    force += r[i];
    torque += cross(arm(cell, particles.position[i]), r[i]);
  });
  if (depth_ > 0) levels_.front().load[cell] = {force, torque};
  return static_cast<double>(energy.sum());
}

double RigidMultigrid::solve() {
  if (depth_ == 0) return 0;
  for (std::size_t k = 0; k < depth_; ++k) {
    levels_[k].relax_from_zero();
    if (k + 1 < depth_) levels_[k].restrict_to(levels_[k + 1]);
  }
  for (std::size_t k = depth_; k-- > 0;) {
    if (k + 1 < depth_) levels_[k].add_from(levels_[k + 1]);
    levels_[k].relax();
  }
  const RigidLevel& level = levels_.front();
  const double own = sum_over_cells(0.0, [&](std::size_t cell) {
    if (!level.is_own(cell)) return 0.0;
    return level.load[cell].linear.cast<double>().dot(level.motion[cell].linear.cast<double>()) +
           level.load[cell].angular.cast<double>().dot(level.motion[cell].angular.cast<double>());
  });
  return level.sum_of_ranks(own);
}

}  // namespace kappaflow
