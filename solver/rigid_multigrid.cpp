#include "solver/rigid_multigrid.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/parallel.h"

namespace kappaflow {
namespace {

constexpr std::size_t kFinestGrain = 4;  // cells that a task works on
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
Wide cell_along(const Wide& x, float lower, float width) {
  return ((x - lower) * (1 / width)).floor().min(kLastCell);
}

// Codes of a pair in CellSums: in no sum, and in the cell's own.
constexpr float kNoSum = -1, kAnchorSum = 0;

}  // namespace

RigidMultigrid::RigidMultigrid(double spacing) : spacing_(spacing), levels_(1) {}

std::size_t RigidMultigrid::bytes() const {
  std::size_t sum = bytes_of(runs_, first_run_, cell_of_, inverse_diagonal_);
  for (const RigidLevel& level : levels_) sum += level.bytes();
  return sum;
}

/// The sum of w l l^T over pairs, l = (x, arm x x) the load of a unit force along the pair: its lower
/// triangle.
class RigidMultigrid::WideSquares {
 public:
  void add(const WideVec& x, const Wide& weight, const Vec4f& arm) {
    const std::array<Wide, 6> line{
        x.x, x.y, x.z, arm[1] * x.z - arm[2] * x.y, arm[2] * x.x - arm[0] * x.z, arm[0] * x.y - arm[1] * x.x};
    std::size_t k = 0;
    for (std::size_t a = 0; a < 6; ++a) {
      const Wide scaled = weight * line[a];
      for (std::size_t b = 0; b <= a; ++b) sums_[k++] += scaled * line[b];
    }
    empty_ = false;
  }

  void add_to(RigidMatrix& matrix) const {
    if (empty_) return;
    std::size_t k = 0;
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b <= a; ++b) {
        const float sum = sums_[k++].sum();
        matrix(rigid::row_of(a), b) += sum;
        if (a != b) matrix(rigid::row_of(b), a) += sum;
      }
  }

 private:
  std::array<Wide, 21> sums_ = filled();
  bool empty_ = true;

  static std::array<Wide, 21> filled() {
    std::array<Wide, 21> zeros;
    zeros.fill(Wide::Zero());
    return zeros;
  }
};

/// Sums over the pairs of a cell's particles.
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
        centre_(grid.levels_[0].centre[cell]),
        anchor_(grid.levels_[0].anchor[cell]) {
    into_[0] = &anchor_;
    const auto place = RigidLevel::place_of(grid.levels_[0].key[cell]);
    for (std::size_t a = 0; a < 3; ++a) place_[a] = static_cast<float>(place[a]);
    for (const RigidLevel::Link& link : grid.levels_[0].links_from(cell)) {
      const auto other = RigidLevel::place_of(grid.levels_[0].key[link.to]);
      const auto code = other[0] - place[0] + 3 * (other[1] - place[1]) + 9 * (other[2] - place[2]);
      const std::ptrdiff_t k = &link - grid.levels_[0].links.data();
      into_[static_cast<std::size_t>(code)] = &grid.levels_[0].coupling[static_cast<std::size_t>(k)];
    }
  }

  /// Writes what has been added.
  void finish() const {
    for (std::size_t k = 0; k < sums_.size(); ++k)
      if (into_[k] != nullptr) sums_[k].add_to(*into_[k]);
  }

  void add(std::size_t i) {
    Vec4f arm = particles_.position[i] - centre_;
    arm[3] = 0;
    Wide xx = Wide::Zero(), yy = xx, zz = xx, xy = xx, xz = xx, yz = xx;
    forces_.for_pairs(i, particles_, lists_, [&](const PairBlock& block, const WideVec& x, const Wide& w) {
      xx += w * x.x * x.x;
      yy += w * x.y * x.y;
      zz += w * x.z * x.z;
      xy += w * x.x * x.y;
      xz += w * x.x * x.z;
      yz += w * x.y * x.z;
      if (!grid_.weak_) couple(block, x, w, arm);
    });
    Eigen::Matrix3d pairs;
    pairs << xx.sum(), xy.sum(), xz.sum(), xy.sum(), yy.sum(), yz.sum(), xz.sum(), yz.sum(), zz.sum();
    add_inertia(arm);
    if (walls_.touches(i)) add_wall(i, arm, pairs);
    grid_.inverse_diagonal_[i] = inverse_of(pairs);
  }

 private:
  /// Adds those of the pairs that are between two cells, or with a particle that is led.
  void couple(const PairBlock& block, const WideVec& x, const Wide& weight, const Vec4f& arm) {
    const WideVec xj = gather(particles_.position, block);
    Wide code = offset(xj.x, 0) + 3 * offset(xj.y, 1) + 9 * offset(xj.z, 2);
    code = (code > 0 && weight > 0).select(code, kNoSum);
    if (grid_.any_led_) find_led(block, weight, code);
    if ((code == kNoSum).all()) return;
    for (int k = 0; k < kWide; ++k) {
      const float sum = code[k];
      if (sum == kNoSum) continue;
      sums_[static_cast<std::size_t>(sum)].add(x, (code == sum).select(time_step_ * weight, 0.0f), arm);
      code = (code == sum).select(kNoSum, code);
    }
  }
  void find_led(const PairBlock& block, const Wide& weight, Wide& code) const {
    for (int k = 0; k < kWide; ++k)
      if (weight[k] > 0 && particles_.led_by[block.base + block.offset[static_cast<std::size_t>(k)]] != 0)
        code[k] = kAnchorSum;
  }
  Wide offset(const Wide& x, std::size_t axis) const;
  void add_inertia(const Vec4f& arm);
  void add_wall(std::size_t i, const Vec4f& arm, Eigen::Matrix3d& pairs);
  SymmetricMatrix inverse_of(const Eigen::Matrix3d& pairs) const;

  RigidMultigrid& grid_;
  const ViscousForces& forces_;
  const FluidParticles& particles_;
  const NeighbourLists& lists_;
  const WallSums& walls_;
  float time_step_;
  Vec4f centre_;
  RigidMatrix& anchor_;
  std::array<float, 3> place_;
  std::array<RigidMatrix*, 14> into_{};  // by x + 3 y + 9 z, cells away; itself: its anchor
  std::array<WideSquares, 14> sums_;     // of what goes there
};

/// Cells from this one, -1, 0 or 1.
Wide RigidMultigrid::CellSums::offset(const Wide& x, std::size_t axis) const {
  const float width = static_cast<float>(kCellWidth * grid_.spacing_);
  return cell_along(x, grid_.lower_[static_cast<Eigen::Index>(axis)], width) - place_[axis];
}

void RigidMultigrid::CellSums::add_inertia(const Vec4f& arm) {
  const Eigen::Vector3f a = arm.head<3>();
  const Eigen::Matrix3f inertia = a.squaredNorm() * Eigen::Matrix3f::Identity() - a * a.transpose();
  anchor_.block<3, 3>(4, 3) += inertia;
  for (int c = 0; c < 3; ++c) anchor_(c, c) += 1;
}

void RigidMultigrid::CellSums::add_wall(std::size_t i, const Vec4f& arm, Eigen::Matrix3d& pairs) {
  for (int c = 0; c < 3; ++c)
    pairs.col(c) += forces_.wall_drag(i, particles_, walls_, Vec4f::Unit(c)).head<3>().cast<double>();
  if (grid_.weak_) return;
  for (int c = 0; c < 6; ++c) {
    const Vec4f v = rigid::velocity(RigidVector::Unit(rigid::row_of(c)), arm);
    anchor_.col(c) += rigid::load(time_step_ * forces_.wall_drag(i, particles_, walls_, v), arm);
  }
}

SymmetricMatrix RigidMultigrid::CellSums::inverse_of(const Eigen::Matrix3d& pairs) const {
  const double dt = static_cast<double>(time_step_);
  Eigen::Matrix3d block = Eigen::Matrix3d::Identity() + dt * pairs;
  block.diagonal().array() += kBlockUncertainty * dt * pairs.trace();
  const Eigen::Matrix3f m = block.inverse().cast<float>();
  return {m(0, 0), m(1, 1), m(2, 2), m(1, 2), m(0, 2), m(0, 1)};
}

void RigidMultigrid::build(const ViscousForces& forces, const FluidParticles& particles,
                           const NeighbourLists& lists, const WallSums& walls, float time_step) {
  weak_ = static_cast<double>(forces.largest_viscosity() * time_step) < kWeak * spacing_ * spacing_;
  find_runs(forces, particles);
  find_cells();
  inverse_diagonal_.resize(particles.size());
  parallel_for(
      finest().cells(), [&](std::size_t cell) { find_centre(particles, cell); }, kFinestGrain);
  parallel_for(
      finest().cells(),
      [&](std::size_t cell) {
        CellSums sums(*this, cell, forces, particles, lists, walls, time_step);
        for_particles(cell, [&](std::size_t i) { sums.add(i); });
        sums.finish();
      },
      kFinestGrain);
  depth_ = 0;
  std::ranges::fill(levels_.front().motion, RigidVector::Zero());
  if (weak_) return;
  for (depth_ = 1;; ++depth_) {
    if (levels_.size() == depth_) levels_.emplace_back();
    if (!levels_[depth_].coarsen(levels_[depth_ - 1])) break;
  }
  for (std::size_t k = 0; k < depth_; ++k)
    levels_[k].invert(static_cast<float>(kPointInertia * spacing_ * spacing_));
}

void RigidMultigrid::find_runs(const ViscousForces& forces, const FluidParticles& particles) {
  const std::size_t n = particles.size();
  lower_ = parallel_reduce(
      n, Vec4f(particles.position.front()), [&](std::size_t i) -> Vec4f { return particles.position[i]; },
      [](const Vec4f& a, const Vec4f& b) -> Vec4f { return a.cwiseMin(b); });
  const float width = static_cast<float>(kCellWidth * spacing_);
  cell_of_.resize(n);
  runs_.clear();
  any_led_ = false;
  bool in_run = false;
  for (std::uint32_t i = 0; i < n; ++i) {
    const bool led = particles.led_by[i] != 0;
    any_led_ = any_led_ || led;
    cell_of_[i] = RigidLevel::kNone;
    const bool was_in_run = std::exchange(in_run, !led && forces.act_on(i, particles));
    if (!in_run) continue;
    std::array<std::int64_t, 3> place;
    for (int a = 0; a < 3; ++a)
      place[static_cast<std::size_t>(a)] =
          static_cast<std::int64_t>(cell_along(particles.position[i][a], lower_[a], width));
    const std::uint64_t key = RigidLevel::key_of(place);
    if (!was_in_run || key != runs_.back().key) runs_.push_back({key, i, i});
    runs_.back().end = i + 1;
  }
}

void RigidMultigrid::find_cells() {
  std::ranges::sort(
      runs_, [](const Run& a, const Run& b) { return a.key != b.key ? a.key < b.key : a.begin < b.begin; });
  std::vector<std::uint64_t> keys;
  first_run_.clear();
  for (std::uint32_t k = 0; k < runs_.size(); ++k)
    if (keys.empty() || runs_[k].key != keys.back()) {
      keys.push_back(runs_[k].key);
      first_run_.push_back(k);
    }
  first_run_.push_back(static_cast<std::uint32_t>(runs_.size()));
  levels_.front().reset(keys);
}

void RigidMultigrid::find_centre(const FluidParticles& particles, std::size_t cell) {
  const Vec4f corner = particles.position[runs_[first_run_[cell]].begin];
  Vec4f sum = Vec4f::Zero();
  for_particles(cell, [&](std::size_t i) {
    cell_of_[i] = static_cast<std::uint32_t>(cell);
    const Vec4f arm = particles.position[i] - corner;
    sum += Vec4f(arm[0], arm[1], arm[2], 1);
  });
  levels_.front().centre[cell] = {corner[0] + sum[0] / sum[3], corner[1] + sum[1] / sum[3],
                                  corner[2] + sum[2] / sum[3], sum[3]};
}

void RigidMultigrid::solve(const FluidParticles& particles, const std::vector<Vec4f>& r) {
  if (depth_ == 0) return;
  RigidLevel& level = levels_.front();
  parallel_for(
      level.cells(),
      [&](std::size_t cell) {
        RigidVector sum = RigidVector::Zero();
        for_particles(cell, [&](std::size_t i) {
          sum += rigid::load(r[i], particles.position[i] - level.centre[cell]);
        });
        level.load[cell] = sum;
      },
      kFinestGrain);
  for (std::size_t k = 0; k < depth_; ++k) {
    levels_[k].relax_from_zero();
    if (k + 1 < depth_) levels_[k].restrict_to(levels_[k + 1]);
  }
  for (std::size_t k = depth_; k-- > 0;) {
    if (k + 1 < depth_) levels_[k].add_from(levels_[k + 1]);
    levels_[k].relax();
  }
}

Vec4f RigidMultigrid::times(const FluidParticles& particles, const std::vector<Vec4f>& r,
                            std::size_t i) const {
  if (!takes_part(i)) return Vec4f::Zero();
  const auto& [xx, yy, zz, yz, xz, xy] = inverse_diagonal_[i];
  const auto& [x, y, z, zero] = std::array{r[i][0], r[i][1], r[i][2], r[i][3]};
  const Vec4f arm = particles.position[i] - finest().centre[cell_of_[i]];
  return Vec4f(xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z, zero) +
         rigid::velocity(finest().motion[cell_of_[i]], arm);
}

}  // namespace kappaflow
