// Which particles of a frame are kept as near the surface, and what is needed to know it.
#include "tools/io/near_surface.h"

#include <fmt/format.h>

#include <numbers>
#include <random>
#include <set>

#include "surface/field/particle_weights.h"
#include "tests/thread_ranks.h"
#include "tests/tools/scratch.h"
#include "tests/tools/sequence_files.h"
#include "tools/io/liquid_depth.h"
#include "tools/io/particle_sequence.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr double kH = 0.25;  // [m] spacing; of two numbers in a CSV exact

/// A jittered cube of n^3 particles from the origin on, with a spherical bubble.
Particles cube(int n, const Vec3& bubble, double radius) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.2, 0.2);
  Particles particles;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const Vec3 x = kH * (Vec3(i, j, k) + Vec3(jitter(random), jitter(random), jitter(random)));
        if ((x - bubble).norm() < radius) continue;
        particles.id.push_back(1 + static_cast<std::int64_t>(particles.id.size()));
        particles.position.push_back(x);
        particles.velocity.emplace_back(1, 0, 0);
      }
  return particles;
}

class NearSurface : public Scratch {
 protected:
  /// In two pieces.
  std::vector<fs::path> frame_of(const Particles& all) const {
    std::vector<fs::path> files;
    for (std::size_t rank = 0; rank < 2; ++rank) {
      Particles piece;
      for (std::size_t i = rank; i < all.size(); i += 2) {
        piece.id.push_back(all.id[i]);
        piece.position.push_back(all.position[i]);
        piece.velocity.push_back(all.velocity[i]);
      }
      files.push_back(file(fmt::format("p_rank{}.csv", rank), csv_text(piece, true, true)));
    }
    return files;
  }
};

TEST_F(NearSurface, IsEverythingWithinFourSigmaOfAirAndOneParticleACubeOfTheRest) {
  constexpr int kN = 44;
  constexpr double kSigma = 2 * kH, kSide = (kN - 1) * kH;
  const Particles all = cube(kN, Vec3::Constant(-1), 0);
  const InputFrame frame = read_near_surface(frame_of(all), kSigma, {});
  EXPECT_EQ(frame.all, all.size());
  std::set<std::int64_t> kept(frame.id.begin(), frame.id.end());
  EXPECT_EQ(kept.size(), frame.id.size()) << "each once";
  const auto depth = [&](const Vec3& x) { return std::min(x.minCoeff(), kSide - x.maxCoeff()) / kSigma; };
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_TRUE(kept.contains(all.id[i]) || depth(all.position[i]) > 4) << depth(all.position[i]);
  std::size_t stand_for = 0;
  for (std::size_t i = 0; i < frame.id.size(); ++i) {
    if (frame.zone[i] <= Zone::inner) continue;
    EXPECT_GT(depth(frame.position[i]), frame.zone[i] == Zone::deep ? 4 : 7);
    stand_for += frame.zone[i] == Zone::deep ? 8 : 64;
  }
  const double left_out = static_cast<double>(all.size() - frame.id.size());
  EXPECT_NEAR(static_cast<double>(stand_for), left_out, 0.15 * left_out) << "as many as in their cubes";
  EXPECT_GT(left_out, 0.08 * static_cast<double>(all.size()));
  EXPECT_DOUBLE_EQ(frame.fast_speed, 1);
}

std::vector<std::pair<std::int64_t, Zone>> zones_of(const InputFrame& frame) {
  std::vector<std::pair<std::int64_t, Zone>> zones;
  for (std::size_t i = 0; i < frame.id.size(); ++i) zones.emplace_back(frame.id[i], frame.zone[i]);
  std::ranges::sort(zones);
  return zones;
}

// Ranks that have the particles of boxes, and one that has every fifth.
TEST_F(NearSurface, IsTheSameOfRanksThatShareTheLiquid) {
  constexpr int kN = 60;
  const Particles all = cube(kN, Vec3(5, 6, 7), 1.5);
  const auto part_of = [&](int rank, int ranks) {
    InputFrame part;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Vec3& x = all.position[i];
      const int owner = ranks == 1 || all.id[i] % 5 == 0 ? 0
                        : ranks == 2                     ? 1
                                                         : 1 + (x.x() > 7) + 2 * (x.z() > 6.3) * (ranks > 3);
      if (owner != rank) continue;
      part.id.push_back(all.id[i]);
      part.position.push_back(x);
      part.velocity.push_back(all.velocity[i]);
    }
    return part;
  };
  const auto alone = zones_of(near_surface_of(part_of(0, 1), 2 * kH, nullptr));
  EXPECT_EQ(alone, zones_of(read_near_surface(frame_of(all), 2 * kH, {})));
  for (const int size : {2, 3, 5}) {
    RankBoard board(size);
    std::vector<std::jthread> others;
    for (int rank = 1; rank < size; ++rank)
      others.emplace_back([&, rank] {
        ThreadRanks ranks(board, rank);
        EXPECT_TRUE(near_surface_of(part_of(rank, size), 2 * kH, &ranks).id.empty());
      });
    ThreadRanks ranks(board, 0);
    const InputFrame found = near_surface_of(part_of(0, size), 2 * kH, &ranks);
    EXPECT_EQ(found.all, all.size());
    EXPECT_EQ(zones_of(found), alone) << size;
  }
}

TEST_F(NearSurface, IsAroundASmallBubbleToo) {
  constexpr int kN = 50;
  const Vec3 middle = Vec3::Constant(0.5 * (kN - 1) * kH);
  const Particles all = cube(kN, middle, 2 * kH);
  const InputFrame frame = read_near_surface(frame_of(all), 2 * kH, {});
  const std::set<std::int64_t> kept(frame.id.begin(), frame.id.end());
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_TRUE(kept.contains(all.id[i]) || (all.position[i] - middle).norm() > 8 * kH);
}

TEST_F(NearSurface, HasWhatTheFrameBeforeHad) {
  const Particles all = cube(44, Vec3::Constant(-1), 0);
  const auto files = frame_of(all);
  const InputFrame alone = read_near_surface(files, 2 * kH, {});
  const std::set<std::int64_t> kept(alone.id.begin(), alone.id.end());
  std::vector<std::int64_t> others;
  for (const std::int64_t id : all.id)
    if (!kept.contains(id) && others.size() < 100) others.push_back(id);
  ASSERT_EQ(others.size(), 100u);
  const InputFrame with = read_near_surface(files, 2 * kH, others);
  EXPECT_EQ(with.id.size(), alone.id.size() + others.size());
  EXPECT_EQ(std::ranges::count(with.zone, Zone::passing), 100);
}

TEST_F(NearSurface, FindsTheSpacingByItself) {
  EXPECT_NEAR(rough_spacing(frame_of(cube(40, Vec3::Constant(-1), 0))), kH, 0.1 * kH);
}

// Spray: blocks around every one of its particles would take a hundred times as much as they do.
TEST_F(NearSurface, GivesUpWhereParticlesAreScattered) {
  const Particles body = cube(20, Vec3::Constant(-1), 0);
  std::vector<Vec3> spray;
  for (int i = 0; i < 4000; ++i) spray.emplace_back(100 + 20 * kH * i, 0, 0);
  constexpr std::size_t kFree = 1 << 22;  // 4 MB: a few hundred of them
  LiquidDepth both(2 * kH, kFree);
  both.add(body.position);
  EXPECT_FALSE(both.scattered());
  both.add(spray);
  EXPECT_TRUE(both.scattered());
  EXPECT_LT(both.bytes(), std::size_t{1} << 16);
  both.add(body.position);
  both.measure();
  EXPECT_EQ(both.zone(Vec3::Constant(10 * kH)), Zone::surface);
  LiquidDepth few(2 * kH, kFree);
  few.add(body.position);
  few.add(std::span(spray).first(100));
  few.measure();
  EXPECT_FALSE(few.scattered());
  EXPECT_GT(few.zone(Vec3::Constant(10 * kH)), Zone::surface);
}

// A sigma of many spacings: more particles under each kernel.
TEST_F(NearSurface, KnowsTheInsideOfWideKernelsToo) {
  const Particles all = cube(80, Vec3::Constant(-1), 0);
  for (const double ratio : {2.0, 3.0, 6.0}) {
    LiquidDepth depth(ratio * kH);
    depth.add(all.position);
    depth.measure();
    const double expected = 64 * std::numbers::pi / 315 * ratio * ratio * ratio;
    EXPECT_NEAR(depth.inside(), expected, 0.06 * expected) << ratio;
  }
}

// In bulk: 4 bytes a node for the sums and 1 for the zone, nodes a spacing apart.
TEST_F(NearSurface, TakesAFewBytesAParticle) {
  const Particles all = cube(96, Vec3::Constant(-1), 0);
  LiquidDepth depth(2 * kH);
  depth.add(all.position);
  const auto n = static_cast<double>(all.size());
  EXPECT_LT(static_cast<double>(depth.bytes()), 7 * n) << "blocks of 8^3 reach beyond the cube";
  depth.measure();
  EXPECT_LT(static_cast<double>(depth.bytes()), 2 * n);
  EXPECT_NEAR(depth.inside(), 64 * std::numbers::pi / 315 * 8, 0.3);
}

TEST_F(NearSurface, IsWhatASequenceKeepsOfLargeFramesWithVelocities) {
  for (const bool velocities : {true, false}) {
    for (int k = 0; k < 2; ++k)
      file(fmt::format("s_{}.csv", k), csv_text(cube(40, Vec3::Constant(-1), 0), true, velocities));
    const auto sequence = [&](const ParticleChoice& choice) {
      return ParticleSequence(file_series(std::vector{(folder / "s_*.csv").string()}), 10, {}, choice);
    };
    EXPECT_EQ(sequence({.many = 60000}).keeps_all(), !velocities);
    EXPECT_TRUE(sequence({.many = 64000}).keeps_all());
    EXPECT_TRUE(sequence({.all = true, .many = 60000}).keeps_all());
    ParticleSequence near = sequence({.many = 60000});
    EXPECT_EQ(near.particles_in(1), 64000u);
    const std::string notes = fmt::format("{}", fmt::join(near.notes(), "; "));
    EXPECT_NE(
        notes.find(velocities ? "particles a frame are near the surface, or stand for others in the depth"
                              : "all particles are kept, also in the depth: they have ids and no velocities"),
        std::string::npos)
        << notes;
  }
}

// What all particles give is known by the functions themselves.
TEST_F(NearSurface, GivesSpacingAndThresholdFromBelowTheSurface) {
  const Particles all = cube(50, Vec3::Constant(-1), 0);
  for (int k = 0; k < 2; ++k) file(fmt::format("s_{}.csv", k), csv_text(all, true, true));
  ParticleSequence near(file_series(std::vector{(folder / "s_*.csv").string()}), 10, {}, {.many = 100'000});
  const auto [position, counted] = near.inside();
  EXPECT_GT(counted.size(), 10000u);
  const double spacing = particle_spacing(all.position), sigma = 2 * spacing;
  EXPECT_NEAR(particle_spacing(position, {}, counted), spacing, 0.003 * spacing);
  const std::vector<double> ones(all.size(), 1);
  const double threshold = half_median_threshold(all.position, ones, sigma);
  EXPECT_NEAR(half_median_threshold(position, std::span(ones).first(position.size()), sigma, {}, counted),
              threshold, 0.02 * threshold);
}

}  // namespace
}  // namespace kappaflow
