#include "surface/tracker/origin_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "surface/mesh/triangle_mesh.h"
#include "surface/tracker/particle_origins.h"

namespace kappaflow {
namespace {

constexpr double kSpacing = 0.1, kSigma = 0.2;

/// Jittered particles of a block of 8^3 around the origin.
Particles block(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-0.2 * kSpacing, 0.2 * kSpacing);
  Particles particles;
  for (int k = 0; k < 512; ++k) {
    particles.id.push_back(k);
    const Vec3 cell(k % 8 - 3.5, k / 8 % 8 - 3.5, k / 64 - 3.5);
    particles.position.push_back(kSpacing * cell + Vec3(jitter(random), jitter(random), jitter(random)));
    particles.velocity.emplace_back(0, 0, 0);
  }
  return particles;
}

std::vector<Vec3> mapped(const std::vector<Vec3>& position, const auto& map) {
  std::vector<Vec3> result;
  for (const Vec3& x : position) result.push_back(map(x));
  return result;
}

Origin origin_at(const OriginMap& map, const Vec3& x) {
  OriginMap::Voters voters;
  return map.at(x, voters).value();
}

const std::vector<Vec3> kPlaces{
    {0.02, -0.01, 0.03}, {0.4, 0.1, 0.2}, {-0.2, 0.37, -0.37}};  // two outside of all particles

TEST(OriginMap, WhatHasNotMovedIsWhereItWas) {
  const Particles particles = block(1);
  const OriginMap map(particles, particles.position, {}, kSigma);
  for (const Vec3& x : kPlaces) {
    EXPECT_LT((origin_at(map, x).position - x).norm(), 1e-12);
    EXPECT_EQ(origin_at(map, x).source, kUnknownSource);
  }
  OriginMap::Voters voters;
  EXPECT_FALSE(map.at(Vec3(9, 0, 0), voters).has_value());
}

TEST(OriginMap, FollowsATurnAndUpToTheRidgeAStrain) {
  const Particles particles = block(2);
  const Mat3 turn = Eigen::AngleAxisd(2, Vec3(1, -2, 2).normalized()).toRotationMatrix();
  const Mat3 strain{{1.2, 0.3, 0}, {0.1, 0.8, 0.2}, {0.1, 0, 1.1}};
  for (const bool strained : {false, true}) {
    const auto back = [&](const Vec3& x) -> Vec3 {
      return Vec3(5, -3, 1) + (strained ? Mat3(turn * strain) : turn) * x;
    };
    const OriginMap map(particles, mapped(particles.position, back), {}, kSigma);
    for (const Vec3& x : kPlaces)
      EXPECT_LT((origin_at(map, x).position - back(x)).norm(), strained ? 0.02 * kSigma : 1e-12);
  }
}

// A layer of particles says nothing of what is above it, but that it turns with the layer.
TEST(OriginMap, ALayerTurnsAsAWhole) {
  Particles layer = block(6);
  for (Vec3& x : layer.position) x.z() = 0;
  const Mat3 turn = Eigen::AngleAxisd(1.3, Vec3(2, 1, 0.5).normalized()).toRotationMatrix();
  const OriginMap map(layer, mapped(layer.position, [&](const Vec3& x) -> Vec3 { return turn * x; }), {},
                      kSigma);
  for (const Vec3& x : {Vec3(0.1, 0, 0.05), Vec3(-0.02, 0.03, -0.1)})
    EXPECT_LT((origin_at(map, x).position - turn * x).norm(), 1e-10);
}

TEST(OriginMap, LiquidFromTwoPlacesDoesNotMix) {
  const Particles particles = block(3);
  // By the cells of the lattice, which the jitter does not leave.
  const auto side = [](const Vec3& x) { return x.x() < 0 ? -1 : 1; };
  const auto back = [&](const Vec3& x) -> Vec3 { return x + Vec3(3.0 * side(x), 0, 0); };
  const OriginMap torn(particles, mapped(particles.position, back), {}, kSigma);
  // Two blocks that began a tenth of a spacing apart in time, say: only their sources tell them apart.
  const auto near = [&](const Vec3& x) -> Vec3 { return x + Vec3(0.3 * kSigma * side(x), 0, 0); };
  std::vector<int> source;
  for (const Vec3& x : particles.position) source.push_back(5 + side(x));
  const OriginMap sources(particles, mapped(particles.position, near), source, kSigma);
  for (const double x : {-0.1, -0.06, 0.06, 0.1})
    for (const double y : {0.0, 0.4}) {
      const Vec3 place(x, y, 0.02);
      EXPECT_LT((origin_at(torn, place).position - back(place)).norm(), 1e-12) << x;
      EXPECT_LT((origin_at(sources, place).position - near(place)).norm(), 1e-12) << x;
      EXPECT_EQ(origin_at(sources, place).source, x < 0 ? 4 : 6);
    }
  for (double x = -0.05; x < 0.05; x += 0.004) {  // where both are about as heavy it is one of them
    const Vec3 place(x, 0.01, 0.02), moved = origin_at(torn, place).position - place;
    EXPECT_LT(std::abs(std::abs(moved.x()) - 3), 1e-12);
    EXPECT_EQ(origin_at(sources, place).source, origin_at(sources, place).position.x() < x ? 4 : 6);
  }
}

TEST(OriginMap, ASideIsKeptWhereItIsThere) {
  const Particles particles = block(5);
  const auto back = [&](const Vec3& x) -> Vec3 { return x + Vec3(x.x() < 0 ? -3 : 3, 0, 0); };
  std::vector<int> source;
  for (const Vec3& x : particles.position) source.push_back(x.x() < 0 ? 4 : 6);
  const OriginMap map(particles, mapped(particles.position, back), {}, kSigma),
      named(particles, mapped(particles.position, back), source, kSigma);
  OriginMap::Voters voters;
  const Vec3 place(0.04, 0.01, 0.02), left = place - Vec3(3, 0, 0), right = place + Vec3(3, 0, 0);
  for (const Vec3& side : {left, right}) {
    const Vec3 near = side + Vec3(0.5, 0.3, -0.4);  // drifted
    EXPECT_LT((map.at(place, {near, kUnknownSource}, voters).value().position - side).norm(), 1e-12);
  }
  EXPECT_LT((named.at(place, {right, 4}, voters).value().position - left).norm(), 1e-12) << "sources decide";
  EXPECT_FALSE(named.at(place, {right, 5}, voters).has_value()) << "there is none of that source";
  EXPECT_FALSE(named.at(Vec3(0.2, 0, 0), {left, 4}, voters).has_value()) << "its liquid is not here";
}

/// Mean distance from where `places` were, of what the map says with and without what they carried along.
struct Errors {
  double carried = 0, fitted = 0, together = 0;
};
Errors errors(const OriginMap& map, const std::vector<Vec3>& places, double drift) {
  std::mt19937 random(8);
  std::normal_distribution<double> normal(0, drift / std::sqrt(3));
  OriginMap::Voters voters;
  Errors sum;
  for (const Vec3& x : places) {
    const Vec3 carried = x + Vec3(normal(random), normal(random), normal(random));
    sum.carried += (carried - x).norm();
    sum.fitted += (map.at(x, voters).value().position - x).norm();
    sum.together += (map.at(x, {carried, kUnknownSource}, voters).value().position - x).norm();
  }
  const double n = static_cast<double>(places.size());
  return {sum.carried / n, sum.fitted / n, sum.together / n};
}

// Particles that have moved about each other, by 0.03 sigma and by sigma, below the top of their block.
TEST(OriginMap, WhatAVertexCarriedCountsByHowWellParticlesKnow) {
  const Particles particles = block(7);
  std::mt19937 random(9);
  std::vector<Vec3> places;
  for (int k = 0; k < 200; ++k) {
    std::uniform_real_distribution<double> inside(-0.25, 0.25);
    places.emplace_back(inside(random), inside(random), 0.35);
  }
  const auto moved_about = [&](double distance) {
    std::normal_distribution<double> normal(0, distance / std::sqrt(3));
    return mapped(particles.position, [&](const Vec3& x) -> Vec3 {
      return x + Vec3(normal(random), normal(random), normal(random));
    });
  };
  const OriginMap known(particles, moved_about(0.03 * kSigma), {}, kSigma);
  const Errors small = errors(known, places, 0.001 * kSigma), large = errors(known, places, kSigma);
  EXPECT_LT(small.together, 0.7 * small.fitted) << "noise is not taken over";
  EXPECT_LT(large.together, 1.1 * large.fitted);
  EXPECT_LT(large.together, 0.1 * large.carried) << "drift goes";
  const OriginMap guess(particles, moved_about(kSigma), {}, kSigma);
  const Errors guessed = errors(guess, places, 0.2 * kSigma);
  EXPECT_GT(guessed.fitted, 2 * guessed.carried);
  EXPECT_NEAR(guessed.together, guessed.carried, 0.05 * guessed.carried);
}

// Lone particles say where they began; a few that have moved about each other, or a sheet that has been drawn
// out, do not say it of what is beside them.
TEST(OriginMap, FewParticlesAndSheetsAreGuessesUnlessTheyMoveAsOne) {
  const Vec3 x(0.01, 0.02, 0.25 * kSigma), drift = Vec3(0.1, 0, 0.1) * kSigma;
  OriginMap::Voters voters;
  const auto correction = [&](const Particles& particles, const auto& origin) {
    const OriginMap map(particles, mapped(particles.position, origin), {}, kSigma);
    const Vec3 own = origin(x) + drift;
    return (map.at(x, {own, kUnknownSource}, voters).value().position - own).norm();
  };
  const auto resting = [](const Vec3& y) -> Vec3 { return y; };
  std::mt19937 random(11);
  std::normal_distribution<double> normal(0, 0.4 * kSigma);
  const auto noisy = [&](const Vec3& y) -> Vec3 {
    return y + Vec3(normal(random), normal(random), normal(random));
  };
  const auto drawn_out = [](const Vec3& y) -> Vec3 { return Vec3(y.x() / 2, y.y() / 2, 4 * y.z()); };
  const double whole = drift.norm();
  for (const int few : {1, 2, 3, 4}) {
    Particles drop;
    for (int k = 0; k < few; ++k) {
      drop.id.push_back(k);
      drop.position.emplace_back(0.4 * kSigma * Vec3(k % 2, k / 2, k == 3));
    }
    EXPECT_NEAR(correction(drop, resting), whole, 1e-12) << few;
    if (few > 1) {
      EXPECT_LT(correction(drop, noisy), 0.5 * whole) << few;
    }
  }
  Particles sheet = block(12);
  for (Vec3& y : sheet.position) y.z() = 0;
  EXPECT_NEAR(correction(sheet, resting), whole, 1e-12);
  EXPECT_LT(correction(sheet, drawn_out), 0.1 * whole);
}

// A particle whose origin is far from its neighbours' is what liquid that was drawn out has left there.
TEST(OriginMap, OneThatIsTornFromTheOthersIsAGuess) {
  Particles particles = block(13);
  const Vec3 x = particles.position[300] + Vec3(0.1, 0, 0.1) * kSigma, far(5, 0, 0);
  std::vector<Vec3> origin = particles.position;
  origin[300] += far;
  OriginMap::Voters voters;
  const Vec3 drift = Vec3(0.3, 0, 0) * kSigma;
  const OriginMap torn(particles, origin, {}, kSigma);
  const auto at = [&](const OriginMap& map, const Vec3& own, int source) {
    return map.at(x, {own + drift, source}, voters).value().position;
  };
  EXPECT_EQ(at(torn, x + far, kUnknownSource), x + far + drift);
  EXPECT_LT((at(torn, x, kUnknownSource) - x).norm(), 1e-12) << "many are known";
  std::vector<int> source(particles.size(), 1);
  source[300] = 2;
  const OriginMap drop(particles, origin, source, kSigma);
  EXPECT_LT((at(drop, x + far, 2) - (x + far)).norm(), 1e-12) << "all of another liquid that is here";
}

// What is 0.15 sigma at the origin is 0.15 sigma now, or up to eight times that.
TEST(OriginMap, DrawnOutLiquidIsKnownLess) {
  const Particles particles = block(14);
  const Vec3 x(0.02, 0.01, 0.3), drift(0, 2 * kSigma, 0);
  const auto taken = [&](double stretch) {
    const auto back = [&](const Vec3& y) -> Vec3 {
      return Vec3(y.x() / stretch, std::sqrt(stretch) * y.y(), std::sqrt(stretch) * y.z());
    };
    std::mt19937 random(15);
    std::normal_distribution<double> normal(0, 0.15 * kSigma);
    const std::vector<Vec3> origin = mapped(particles.position, [&](const Vec3& y) -> Vec3 {
      return back(y) + Vec3(normal(random), normal(random), normal(random));
    });
    OriginMap::Voters voters;
    const Vec3 own = back(x) + drift;
    const OriginMap map(particles, origin, {}, kSigma);
    return (map.at(x, {own, kUnknownSource}, voters).value().position - own).norm() / drift.norm();
  };
  EXPECT_GT(taken(1), 0.9);
  EXPECT_LT(taken(8), 0.5);
}

// Each particle within a link of the next, the last more than that from the first.
TEST(OriginMap, LiquidThatWasDrawnOutIsOneSide) {
  const Particles particles = block(4);
  const auto back = [](const Vec3& x) -> Vec3 { return Vec3(3 * x.x(), x.y(), x.z()); };
  const OriginMap map(particles, mapped(particles.position, back), {}, kSigma);
  for (const Vec3& x : kPlaces)
    EXPECT_LT((origin_at(map, x).position - back(x)).norm(), 0.05 * kSigma) << x.transpose();
}

TEST(ParticleOrigins, AreTheFirstPlaces) {
  const auto particles = [](std::vector<std::int64_t> id, double x) {
    Particles p;
    p.id = std::move(id);
    for (const std::int64_t i : p.id) p.position.emplace_back(x, static_cast<double>(i), 0);
    p.velocity.assign(p.id.size(), Vec3::Zero());
    return p;
  };
  ParticleOrigins origins;
  origins.see(particles({2, 5, 9}, 0));
  origins.see(particles({2, 9}, 1));         // 5 goes
  origins.see(particles({1, 2, 9, 12}, 2));  // 1 and 12 come
  const Particles last = particles({1, 5, 9, 12}, 3);
  origins.see(last);
  const std::vector<Vec3> place = origins.of(last);
  EXPECT_EQ(place, (std::vector<Vec3>{{2, 1, 0}, {0, 5, 0}, {0, 9, 0}, {2, 12, 0}}));
}

}  // namespace
}  // namespace kappaflow
