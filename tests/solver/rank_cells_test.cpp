// The viscous preconditioner's cells, shared among ranks, are those of one rank.
#include "solver/rank_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <set>

#include "solver/rigid_level.h"
#include "tests/thread_ranks.h"

namespace kappaflow {
namespace {

using Place = LiquidCut::Place;
using Places = std::set<Place>;

constexpr float kWidth = 4;  // of a cell, of particles 1 apart

Places block(const Place& lower, const Place& upper) {
  Places places;
  for (std::int64_t x = lower[0]; x < upper[0]; ++x)
    for (std::int64_t y = lower[1]; y < upper[1]; ++y)
      for (std::int64_t z = lower[2]; z < upper[2]; ++z) places.insert({x, y, z});
  return places;
}

/// To and fro in x, so that a cut along x crosses it again and again.
Places winding() {
  Places places;
  for (std::int64_t row = 0; row < 6; ++row) {
    places.merge(block({0, 3 * row, 0}, {40, 3 * row + 1, 1}));
    const std::int64_t end = row % 2 == 0 ? 39 : 0;
    places.merge(block({end, 3 * row, 0}, {end + 1, 3 * row + 4, 1}));
  }
  return places;
}

/// Holes at random, and drops apart.
Places spray() {
  Places places;
  std::uint32_t random = 1;
  for (const Place& place : block({0, 0, 0}, {20, 12, 9}))
    if ((random = random * 1664525u + 1013904223u) >> 29 == 0) places.insert(place);
  return places;
}

std::vector<Places> shapes() {
  return {block({-40, 3, 5}, {41, 7, 9}),
          block({-5, -5, -5}, {8, 8, 8}),
          block({0, 0, 0}, {60, 20, 1}),
          winding(),
          spray(),
          block({7, 7, 7}, {8, 8, 8})};
}

float number(std::uint64_t seed) {
  seed = (seed + 1) * 0x9e3779b97f4a7c15;
  seed = (seed ^ seed >> 29) * 0xbf58476d1ce4e5b9;
  return static_cast<float>((seed ^ seed >> 32) & 0xffff) / 0xffff;
}

/// Levels of springs between the cells of liquid, on one of several ranks or alone.
class Levels {
 public:
  Levels(const Places& places, const LiquidCut* cut, Ranks* ranks) : levels_(1) {
    for (const Place& place : places)
      for (std::size_t a = 0; a < 3; ++a) first_[a] = std::min(first_[a], place[a]);
    RigidLevel& finest = levels_.front();
    for (const Place& place : places)
      if (cut == nullptr || cut->owner_of(place) == ranks->rank())
        finest.key.push_back(
            RigidLevel::key_of({place[0] - first_[0], place[1] - first_[1], place[2] - first_[2]}));
    std::ranges::sort(finest.key);
    if (cut != nullptr) finest.share_among(*ranks, *cut, first_);
    finest.reset();
    finest.make_room();
    fill(finest);
    for (bool more = true; more;) {
      levels_.emplace_back();
      more = levels_.back().coarsen(levels_[levels_.size() - 2]);
    }
    levels_.pop_back();
    for (RigidLevel& level : levels_) level.invert(0.01f);
  }

  /// One V-cycle for a load that is random.
  void solve() {
    for (std::size_t cell = 0; cell < levels_.front().cells(); ++cell) {
      const std::uint64_t seed = 8 * levels_.front().key[cell];
      levels_.front().load[cell] = {{number(seed) - 0.5f, number(seed + 1) - 0.5f, number(seed + 2), 0},
                                    {number(seed + 3) - 0.5f, number(seed + 4), number(seed + 5) - 0.5f, 0}};
    }
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      levels_[k].relax_from_zero();
      if (k + 1 < levels_.size()) levels_[k].restrict_to(levels_[k + 1]);
    }
    for (std::size_t k = levels_.size(); k-- > 0;) {
      if (k + 1 < levels_.size()) levels_[k].add_from(levels_[k + 1]);
      levels_[k].relax();
    }
  }

  const std::vector<RigidLevel>& levels() const { return levels_; }
  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const RigidLevel& level : levels_) sum += level.bytes();
    return sum;
  }

 private:
  static void fill(RigidLevel& level) {
    for (std::size_t cell = 0; cell < level.cells(); ++cell) {
      if (!level.is_own(cell)) continue;
      const auto place = RigidLevel::place_of(level.key[cell]);
      for (int a = 0; a < 3; ++a)
        level.centre[cell][a] = kWidth * (static_cast<float>(place[static_cast<std::size_t>(a)]) + 0.5f) +
                                number(3 * level.key[cell] + static_cast<std::uint64_t>(a));
      level.centre[cell][3] = 64;
    }
    level.share_values(level.centre);
    const auto grip = [](float strength, const Eigen::Vector3f& arm) {
      RigidMatrix sum;
      for (int a = 0; a < 3; ++a)
        for (const float side : {-1.0f, 1.0f})
          sum += rigid::matrix_at(SymmetricMatrix{strength, strength, strength},
                                  arm + side * Eigen::Vector3f::Unit(a));
      return sum;
    };
    for (std::uint32_t cell = 0; cell < level.cells(); ++cell) {
      if (!level.is_own(cell)) continue;
      level.anchor[cell] = grip(0.3f + number(level.key[cell]), Eigen::Vector3f::Zero());
      for (std::uint32_t k = level.first_link[cell]; k < level.first_link[cell + 1]; ++k) {
        const std::uint32_t to = level.links[k].to;
        level.coupling[k] = grip(30 * number(level.key[cell] + 7 * level.key[to]),
                                 0.5f * (level.centre[to] - level.centre[cell]).head<3>());
      }
    }
  }

  Place first_{LiquidCut::kLargestPlace, LiquidCut::kLargestPlace, LiquidCut::kLargestPlace};
  std::vector<RigidLevel> levels_;
};

/// Calls work(levels, rank), one rank at a time, with what each of so many ranks has made of the cells.
void on_ranks_with_levels(const Places& places, int size, const std::function<void(Levels&, int)>& work) {
  if (size == 1) {
    Levels alone(places, nullptr, nullptr);
    alone.solve();
    return work(alone, 0);
  }
  RankBoard board(size);
  std::mutex one_at_a_time;
  std::vector<std::jthread> threads;
  for (int rank = 0; rank < size; ++rank)
    threads.emplace_back([&, rank] {
      ThreadRanks ranks(board, rank);
      LiquidCut cut(1);
      std::vector<Vec4f> position;
      if (rank == 0)
        for (const Place& place : places)
          position.emplace_back(kWidth * (static_cast<float>(place[0]) + 0.5f),
                                kWidth * (static_cast<float>(place[1]) + 0.5f),
                                kWidth * (static_cast<float>(place[2]) + 0.5f), 0.0f);
      cut.cut(position, ranks);
      Levels levels(places, &cut, &ranks);
      levels.solve();
      const std::lock_guard lock(one_at_a_time);
      work(levels, rank);
    });
}

bool touch(std::uint64_t a, std::uint64_t b) {
  const auto p = RigidLevel::place_of(a), q = RigidLevel::place_of(b);
  return std::abs(p[0] - q[0]) <= 1 && std::abs(p[1] - q[1]) <= 1 && std::abs(p[2] - q[2]) <= 1;
}

// Also of liquid in which levels above the finest are shared, and where a rank has no cell.
TEST(RankCells, SolveAsOneRankDoes) {
  for (const Places& places : shapes()) {
    std::map<std::uint64_t, RigidVector> alone;
    float largest = 0;
    std::size_t depth = 0;
    on_ranks_with_levels(places, 1, [&](Levels& levels, int) {
      const RigidLevel& finest = levels.levels().front();
      for (std::size_t cell = 0; cell < finest.cells(); ++cell) {
        alone[finest.key[cell]] = finest.motion[cell];
        largest = std::max(largest, finest.motion[cell].linear.norm());
      }
      depth = levels.levels().size();
    });
    for (const int size : {2, 3, 5, 8}) {
      float difference = 0;
      std::size_t solved = 0;
      on_ranks_with_levels(places, size, [&](Levels& levels, int) {
        EXPECT_GE(levels.levels().size(), depth);
        const RigidLevel& finest = levels.levels().front();
        for (std::size_t cell = 0; cell < finest.cells(); ++cell) {
          const RigidVector apart = finest.motion[cell] - alone.at(finest.key[cell]);
          difference = std::max({difference, apart.linear.norm(), apart.angular.norm()});
          solved += finest.is_own(cell);
        }
      });
      EXPECT_EQ(solved, places.size());
      EXPECT_LT(difference, 2e-5f * largest) << size << " ranks, " << places.size() << " cells";
    }
  }
}

TEST(RankCells, ListWhatIsBesideTheirsAndNoMore) {
  for (const Places& places : shapes())
    for (const int size : {2, 4, 7}) {
      std::vector<std::set<std::uint64_t>> all;  // by level
      on_ranks_with_levels(places, 1, [&](Levels& levels, int) {
        for (const RigidLevel& level : levels.levels()) all.emplace_back(level.key.begin(), level.key.end());
      });
      std::vector<std::size_t> owned(all.size(), 0);
      on_ranks_with_levels(places, size, [&](Levels& levels, int) {
        for (std::size_t k = 0; k < std::min(all.size(), levels.levels().size()); ++k) {
          const RigidLevel& level = levels.levels()[k];
          std::set<std::uint64_t> own, needed;
          for (std::size_t cell = 0; cell < level.cells(); ++cell)
            if (level.is_own(cell)) own.insert(level.key[cell]);
          owned[k] += own.size();
          if (own.size() == all[k].size()) continue;  // of a whole level, or of liquid of one cell
          for (const std::uint64_t key : all[k])
            if (std::ranges::any_of(own, [&](std::uint64_t o) { return touch(o, key); })) needed.insert(key);
          if (k > 0)
            for (const std::uint64_t key : levels.levels()[k - 1].key) needed.insert(key >> 3);
          EXPECT_EQ(std::set(level.key.begin(), level.key.end()), needed) << size << " ranks, level " << k;
        }
      });
      EXPECT_EQ(owned.front(), places.size());
    }
}

// A rank of a long slab has two borders, of sixteen cells each. A quarter of what two ranks take is of the
// level that is whole.
TEST(RankCells, TakeMemoryOfTheirShare) {
  const Places slab = block({0, 0, 0}, {512, 4, 4});
  std::size_t of_one = 0;
  on_ranks_with_levels(slab, 1, [&](Levels& levels, int) { of_one = levels.bytes(); });
  for (const int size : {2, 8})
    on_ranks_with_levels(slab, size, [&](Levels& levels, int rank) {
      const std::size_t share = slab.size() / static_cast<std::size_t>(size);
      EXPECT_LE(levels.levels().front().cells(), share + 2 * 16) << rank;
      EXPECT_LT(static_cast<double>(levels.bytes()) * size, 1.3 * static_cast<double>(of_one)) << rank;
    });
}

}  // namespace
}  // namespace kappaflow
