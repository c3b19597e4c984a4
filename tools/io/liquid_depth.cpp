#include "tools/io/liquid_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/bytes.h"
#include "core/parallel.h"
#include "solver/rank_exchange.h"

namespace kappaflow {
namespace {

constexpr double kFull = 0.75;             // of the sum inside: less is taken for surface
constexpr std::array kWidths{3, 2, 4, 6};  // of the zones but the last [steps]
constexpr std::size_t kOfParticle = 200;   // bytes of one that is kept, with ids and velocities
constexpr std::int64_t kFarthest = std::int64_t{1} << 20;  // from the origin: keys have 21 bits an axis

std::int64_t block_with(std::int64_t node) {
  return node >> 3;
}

template <std::size_t n>
void add_to(std::array<float, n>& sums, const std::array<float, n>& more) {
  for (std::size_t k = 0; k < n; ++k) sums[k] += more[k];
}

/// Along its edge.
int cube_nodes(Zone zone) {
  return zone == Zone::deepest ? 4 : 2;
}

}  // namespace

std::uint64_t LiquidDepth::key_of(const Node& block) {
  std::uint64_t key = 0;
  for (const std::int64_t b : block) key = key << 21 | static_cast<std::uint64_t>(b + kFarthest);
  return key;
}

LiquidDepth::Node LiquidDepth::node_at(const Vec3& x) const {
  SpaceCell node = space_cell(x + Vec3::Constant(0.5 * step_), step_);
  for (std::int64_t& n : node) n = std::clamp(n, -2 * kFarthest + 8, 2 * kFarthest - 9);
  return node;
}

LiquidDepth::Sums& LiquidDepth::sums_of(const Node& block) {
  const auto [at, is_new] = block_of_.try_emplace(key_of(block), static_cast<std::uint32_t>(block_.size()));
  if (is_new) {
    block_.push_back(block);
    sums_.emplace_back().fill(0);
  }
  return sums_[at->second];
}

void LiquidDepth::add(std::span<const Vec3> position) {
  for (const Vec3& x : position) {
    if (scattered_) return;
    add(x);
    ++added_;
    if (sums_.size() * sizeof(sums_[0]) > free_ + kOfParticle * added_) give_up();
  }
}

void LiquidDepth::add(LiquidDepth others) {
  if (scattered_ || others.scattered_) return give_up();
  for (std::size_t b = 0; b < others.block_.size(); ++b) add_to(sums_of(others.block_[b]), others.sums_[b]);
  added_ += others.added_;
}

void LiquidDepth::give_up() {
  scattered_ = true;
  forget();
}

void LiquidDepth::forget() {
  block_of_.clear();
  block_ = std::vector<Node>();
  sums_ = std::deque<Sums>();
}

void LiquidDepth::add(const Vec3& x) {
  constexpr int kReach = 2;  // steps: a sigma
  const Node centre = node_at(x);
  const Vec3 offset = x / step_ - Vec3(static_cast<double>(centre[0]), static_cast<double>(centre[1]),
                                       static_cast<double>(centre[2]));
  Node first, last;
  for (int a = 0; a < 3; ++a) {
    first[a] = block_with(centre[a] - kReach);
    last[a] = block_with(centre[a] + kReach);
  }
  const auto nodes = [&](std::int64_t block, int a, const auto& visit) {
    const std::int64_t begin = std::max(block * kSide, centre[a] - kReach),
                       end = std::min(block * kSide + kSide - 1, centre[a] + kReach);
    for (std::int64_t n = begin; n <= end; ++n) {
      const double d = static_cast<double>(n - centre[a]) - offset[a];
      visit(static_cast<std::size_t>(n - block * kSide), 0.25 * d * d);
    }
  };
  for (Node b{0, 0, first[2]}; b[2] <= last[2]; ++b[2])
    for (b[1] = first[1]; b[1] <= last[1]; ++b[1])
      for (b[0] = first[0]; b[0] <= last[0]; ++b[0]) {
        Sums& sums = sums_of(b);
        nodes(b[2], 2, [&](std::size_t k, double z2) {
          nodes(b[1], 1, [&](std::size_t j, double y2) {
            nodes(b[0], 0, [&](std::size_t i, double x2) {
              const double u = std::max(0.0, 1 - x2 - y2 - z2);
              sums[(k * kSide + j) * kSide + i] += static_cast<float>(u * u * u);
            });
          });
        });
      }
}

/// Own blocks that reach into what the zones of others follow from.
std::vector<std::vector<LiquidDepth::SharedBlock>> LiquidDepth::blocks_for(Ranks& ranks) const {
  constexpr std::int64_t kReach = 2;  // blocks: no less than the sum of kWidths
  struct Box {
    Node low, high;
  };
  Box own{{kFarthest, kFarthest, kFarthest}, {-kFarthest, -kFarthest, -kFarthest}};
  for (const Node& block : block_)
    for (int a = 0; a < 3; ++a) {
      own.low[a] = std::min(own.low[a], block[a] - kReach);
      own.high[a] = std::max(own.high[a], block[a] + kReach);
    }
  const std::vector<Box> boxes = ranks.one_of_each(own);
  std::vector<std::vector<SharedBlock>> sent(boxes.size());
  for (std::size_t r = 0; r < boxes.size(); ++r) {
    if (static_cast<int>(r) == ranks.rank()) continue;
    const auto [low, high] = boxes[r];
    for (std::size_t b = 0; b < block_.size(); ++b) {
      const Node& at = block_[b];
      if (low[0] <= at[0] && at[0] <= high[0] && low[1] <= at[1] && at[1] <= high[1] && low[2] <= at[2] &&
          at[2] <= high[2])
        sent[r].push_back({at, sums_[b]});
    }
  }
  return sent;
}

void LiquidDepth::add(std::span<const SharedBlock> blocks, int rank) {
  for (const SharedBlock& from : blocks) {
    Sums& sums = sums_of(from.block);
    if (first_.size() < block_.size()) first_.push_back(rank);
    add_to(sums, from.sums);
  }
}

/// Adds what others have in the blocks around own ones, in the order of the ranks, so that all who know a
/// block have the same sums. Who has given up has no blocks: beside it is a surface.
void LiquidDepth::share(Ranks& ranks) {
  const std::vector<std::vector<SharedBlock>> others = swapped(ranks, blocks_for(ranks));
  std::vector<SharedBlock> own(block_.size());
  for (std::size_t b = 0; b < own.size(); ++b) own[b] = {block_[b], sums_[b]};
  forget();
  for (int r = 0; r < ranks.size(); ++r)
    add(r == ranks.rank() ? own : others[static_cast<std::size_t>(r)], r);
}

/// That of which there are most nodes among those above a sum that only the inside has.
void LiquidDepth::find_inside(Ranks* ranks) {
  constexpr double kBin = 0.01, kLeast = 1.5, kMost = 1e6;  // kBin: of the logarithm
  std::vector<std::size_t> count(static_cast<std::size_t>(std::log(kMost / kLeast) / kBin) + 1);
  for (std::size_t b = 0; b < sums_.size(); ++b) {
    if (ranks != nullptr && first_[b] != ranks->rank()) continue;  // is counted there
    for (const float sum : sums_[b])
      if (static_cast<double>(sum) > kLeast)
        ++count[static_cast<std::size_t>(std::log(std::min(static_cast<double>(sum), kMost) / kLeast) /
                                         kBin)];
  }
  if (ranks != nullptr) count = ranks->sum_each(count);
  const std::size_t all = std::accumulate(count.begin(), count.end(), std::size_t{0});
  if (all == 0) {  // there is no inside: all is near a surface
    inside_ = std::numeric_limits<double>::infinity();
    return;
  }
  std::size_t bin = 0;
  for (std::size_t below = count[0]; 2 * below < all; below += count[bin]) ++bin;
  inside_ = kLeast * std::exp(kBin * (static_cast<double>(bin) + 0.5));
}

/// Marks the nodes that have a marked one within so many along the axis. Outside of all blocks each is.
void LiquidDepth::dilate(int axis, int radius, const std::vector<Marks>& from, std::vector<Marks>& to) const {
  constexpr int kLine = 3 * kSide;
  const std::size_t stride = axis == 0 ? 1 : axis == 1 ? kSide : kSide * kSide;
  parallel_for(block_.size(), [&](std::size_t b) {
    std::array<const Marks*, 3> along{};
    for (int n = -1; n <= 1; ++n) {
      Node block = block_[b];
      block[axis] += n;
      if (const auto found = block_of_.find(key_of(block)); found != block_of_.end())
        along[n + 1] = &from[found->second];
    }
    for (std::size_t row = 0; row < kSide * kSide; ++row) {
      const std::size_t begin = axis == 0   ? row * kSide
                                : axis == 1 ? row / kSide * kSide * kSide + row % kSide
                                            : row;
      std::array<int, kLine + 1> before{};  // how many of the line before each node are marked
      for (int n = 0; n < kLine; ++n) {
        const Marks* marks = along[n / kSide];
        const std::size_t at = begin + static_cast<std::size_t>(n % kSide) * stride;
        before[n + 1] = before[n] + (marks == nullptr || (*marks)[at] != 0);
      }
      for (int n = 0; n < kSide; ++n)
        to[b][begin + static_cast<std::size_t>(n) * stride] =
            before[kSide + n + radius + 1] > before[kSide + n - radius];
    }
  });
}

void LiquidDepth::measure(Ranks* ranks) {
  if (ranks != nullptr) share(*ranks);
  find_inside(ranks);
  const std::size_t blocks = block_.size();
  std::vector<Marks> near(blocks), next(blocks);
  parallel_for(blocks, [&](std::size_t b) {
    for (std::size_t n = 0; n < kNodes; ++n) near[b][n] = static_cast<double>(sums_[b][n]) < kFull * inside_;
  });
  sums_ = std::deque<Sums>();
  zones_.resize(blocks);
  for (Marks& zones : zones_) zones.fill(static_cast<std::uint8_t>(Zone::deepest));
  for (std::size_t z = 0; z < kWidths.size(); ++z) {
    dilate(0, kWidths[z], near, next);
    dilate(1, kWidths[z], next, near);
    dilate(2, kWidths[z], near, next);
    near.swap(next);
    parallel_for(blocks, [&](std::size_t b) {
      for (std::size_t n = 0; n < kNodes; ++n)
        if (near[b][n] != 0) zones_[b][n] = std::min(zones_[b][n], static_cast<std::uint8_t>(z));
    });
  }
  parallel_for(blocks, [&](std::size_t b) { fit_to_cubes(zones_[b]); });
}

/// Cubes that are not of a zone as a whole are of the one above.
void LiquidDepth::fit_to_cubes(Marks& zones) {
  for (const Zone zone : {Zone::deepest, Zone::deep}) {
    const int side = cube_nodes(zone), cubes = kSide / side;
    const auto least = static_cast<std::uint8_t>(zone), above = static_cast<std::uint8_t>(least - 1);
    for (int cube = 0; cube < cubes * cubes * cubes; ++cube) {
      const int x = cube % cubes * side, y = cube / cubes % cubes * side, z = cube / cubes / cubes * side;
      const auto for_each_node = [&](const auto& visit) {
        for (int k = z; k < z + side; ++k)
          for (int j = y; j < y + side; ++j)
            for (int i = x; i < x + side; ++i)
              visit(zones[(static_cast<std::size_t>(k) * kSide + static_cast<std::size_t>(j)) * kSide +
                          static_cast<std::size_t>(i)]);
      };
      bool whole = true;
      for_each_node([&](std::uint8_t of_node) { whole = whole && of_node >= least; });
      if (!whole) for_each_node([&](std::uint8_t& of_node) { of_node = std::min(of_node, above); });
    }
  }
}

Zone LiquidDepth::zone(const Vec3& x) const {
  const Node node = node_at(x);
  const Node block{block_with(node[0]), block_with(node[1]), block_with(node[2])};
  const auto found = block_of_.find(key_of(block));
  if (found == block_of_.end()) return Zone::surface;
  const auto in_block = [&](int a) { return static_cast<std::size_t>(node[a] - block[a] * kSide); };
  return static_cast<Zone>(zones_[found->second][(in_block(2) * kSide + in_block(1)) * kSide + in_block(0)]);
}

std::uint64_t LiquidDepth::cube(const Vec3& x, Zone zone) const {
  Node cube = node_at(x);
  for (std::int64_t& c : cube) c >>= zone == Zone::deepest ? 2 : 1;
  return key_of(cube) << 1 | (zone == Zone::deepest ? 1 : 0);
}

double LiquidDepth::squared_distance_from_middle(const Vec3& x, Zone zone) const {
  const Node node = node_at(x);
  const int side = cube_nodes(zone);
  Vec3 middle;
  for (int a = 0; a < 3; ++a)
    middle[a] = step_ * (static_cast<double>(node[a] & ~std::int64_t{side - 1}) + 0.5 * (side - 1));
  return (x - middle).squaredNorm();
}

std::size_t LiquidDepth::bytes() const {
  constexpr std::size_t kHashed = 40;  // of a block: its entry in the table, by libstdc++
  return bytes_of(block_, zones_) + sums_.size() * sizeof(sums_[0]) + kHashed * block_of_.size();
}

}  // namespace kappaflow
