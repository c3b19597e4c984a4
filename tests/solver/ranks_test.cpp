// Liquid that several ranks share moves as it does on one.
#include "solver/ranks.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <sstream>

#include "core/errors.h"
#include "core/quantile.h"
#include "core/saved_state.h"
#include "solver/rank_exchange.h"
#include "solver/wall_bodies.h"
#include "tests/solver/shapes.h"
#include "tests/solver/streams.h"
#include "tests/solver/thread_ranks.h"

namespace kappaflow {
namespace {

constexpr double kSpacing = 0.05;

FluidOptions options(double viscosity) {
  FluidOptions o;
  o.spacing = kSpacing;
  o.kinematic_viscosity = viscosity;
  o.surface_tension = 0.1;
  return o;
}

/// A block that falls onto stairs.
FluidSolver falling_block(double viscosity, Ranks* ranks) {
  const auto points = test::block({-0.9, 0.55, -0.4}, {0.1, 1.05, 0.4}, kSpacing);
  const auto walls = solid_walls(test::stairs(2, 0.2, 0.5, 0.8));
  return {options(viscosity),
          points,
          std::vector<Vec3>(points.size(), Vec3(1, -1, 0)),
          walls,
          {},
          {},
          {},
          {},
          ranks};
}

/// A drop in no gravity that spins, is sheared and vibrates.
FluidSolver spinning_drop(Ranks* ranks) {
  FluidOptions o = options(0.5);
  o.gravity.setZero();
  const std::vector<Vec3> points = test::blob(0.4, kSpacing);
  std::vector<Vec3> velocity;
  for (const Vec3& x : points)
    velocity.push_back(Vec3(0.3, 0.1, 0) + Vec3(0, 1, 2).cross(x) + Vec3(2 * x.y(), 0, std::sin(9 * x.x())));
  return {o, points, velocity, {}, {}, {}, {}, {}, ranks};
}

/// Bodies of liquid in no gravity, each of which moves, spins and is sheared in its own way: one that winds
/// to and fro across the cuts, drops on both sides of it, and one that lies across them.
struct Bodies {
  std::vector<Vec3> points, velocity;
  std::vector<std::size_t> body;  // of each point

  Bodies() {
    add(test::winding(kSpacing));
    for (const Vec3& centre : {Vec3(-0.4, 0.5, 0.1), Vec3(2.0, 0.9, 0.1), Vec3(0.8, 0.7, 0.7)}) {
      std::vector<Vec3> drop = test::blob(0.2, kSpacing);
      for (Vec3& x : drop) x += centre;
      add(drop);
    }
    add(test::block({0.2, 1.8, 0}, {1.4, 2.0, 0.2}, kSpacing));
  }

  void add(const std::vector<Vec3>& of_body) {
    const double k = body.empty() ? 0 : static_cast<double>(body.back()) + 1;
    for (const Vec3& x : of_body) {
      points.push_back(x);
      velocity.push_back(Vec3(0.1 - 0.1 * k, 0.05 * k, 0) + Vec3(0, 0.3, k - 1).cross(x) +
                         Vec3(x.y(), 0, std::sin(9 * x.x())));
      body.push_back(static_cast<std::size_t>(k));
    }
  }
};

/// A stream along x into a box, with a ball on its way that takes its middle.
FluidSolver stream(Ranks* ranks) {
  FluidOptions o = options(0.01);
  test::add_stream(o);
  return {o, {}, {}, {}, {}, {}, {}, {}, ranks};
}

struct Course {
  Particles particles;
  int density = 0, divergence = 0, viscosity = 0;  // iterations of all steps
  double compression = 0;
};

Course course_of(FluidSolver& fluid, int steps) {
  Course course;
  for (int k = 0; k < steps; ++k) {
    const FluidStep step = fluid.step(1e3);
    course.density += step.density_iterations;
    course.divergence += step.divergence_iterations;
    course.viscosity += step.viscosity_iterations;
    course.compression = step.density_error_mean;
  }
  course.particles = fluid.particles();
  return course;
}

Course course_on(int ranks, const std::function<FluidSolver(Ranks*)>& make, int steps) {
  Course course;
  on_ranks(ranks, make, [&](FluidSolver& fluid) { course = course_of(fluid, steps); });
  return course;
}

/// Root mean square, in spacings.
double difference(const Particles& a, const Particles& b) {
  if (a.id != b.id) return INFINITY;
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a.position[i] - b.position[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size())) / kSpacing;
}

Vec3 momentum(const Particles& p) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& v : p.velocity) sum += v;
  return sum;
}
Vec3 angular_momentum(const Particles& p) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < p.size(); ++i) sum += p.position[i].cross(p.velocity[i]);
  return sum;
}

std::string saved(FluidSolver& fluid) {
  std::ostringstream bytes;
  StateWriter(bytes, little_endian())(fluid);
  return std::move(bytes).str();
}
void restore(FluidSolver& fluid, const std::string& bytes) {
  std::istringstream stream(bytes);
  StateReader archive(stream);
  archive(fluid);
}

// Cells of the viscous preconditioner lie elsewhere on one rank, so that its solves end elsewhere within what
// is tolerated; on two and four only rounding differs.
TEST(Ranks, MoveLiquidAsOneDoes) {
  for (const double viscosity : {0.0, 1e-3, 1.0, 100.0}) {
    const auto make = [&](Ranks* ranks) { return falling_block(viscosity, ranks); };
    const Course one = course_on(1, make, 8), two = course_on(2, make, 8), four = course_on(4, make, 8);
    EXPECT_LT(difference(two.particles, one.particles), viscosity > 0 ? 2e-3 : 2e-4) << viscosity;
    EXPECT_LT(difference(two.particles, four.particles), 2e-4) << viscosity;
    EXPECT_NEAR(four.density, one.density, 2) << viscosity;
    EXPECT_NEAR(four.divergence, one.divergence, 2) << viscosity;
    EXPECT_NEAR(four.viscosity, one.viscosity, 0.1 * one.viscosity + 2) << viscosity;
    EXPECT_NEAR(four.compression, one.compression, 0.05 * options(0).density_tolerance) << viscosity;
  }
}

// Of nine ranks coarser levels of the preconditioner are shared too.
TEST(Ranks, AreAlikeHoweverManyTheyAre) {
  const auto make = [](Ranks* ranks) { return falling_block(100, ranks); };
  const Course two = course_on(2, make, 4), nine = course_on(9, make, 4);
  EXPECT_LT(difference(two.particles, nine.particles), 1e-5);
  EXPECT_EQ(two.viscosity, nine.viscosity);
}

// Of five ranks some have no particle that is fast.
TEST(Ranks, FindTheSpeedThatAShareStaysBelow) {
  for (const int size : {1, 2, 5})
    on_ranks(
        size, [](Ranks* ranks) { return falling_block(1, ranks); },
        [&](FluidSolver& fluid) {
          for (int k = 0; k < 3; ++k) fluid.step(1e3);
          const Particles all = fluid.particles();
          std::vector<double> speed;
          for (const Vec3& v : all.velocity) speed.push_back(v.norm());
          for (const double share : {0.0, 0.5, 0.999, 1.0})
            EXPECT_EQ(fluid.fast_speed(share), quantile(speed, share)) << size << " ranks, " << share;
        });
}

TEST(Ranks, GiveTheSameBitsEveryTime) {
  const auto make = [](Ranks* ranks) { return falling_block(1, ranks); };
  EXPECT_EQ(course_on(3, make, 5).particles.position, course_on(3, make, 5).particles.position);
}

// Where the cut lies changes nothing but rounding; and it is where it was after a checkpoint.
TEST(Ranks, MoveLiquidAsOneDoesWhateverTheirShares) {
  const auto make = [](Ranks* ranks) {
    if (ranks != nullptr) ranks->set_shares({1, 0.25, 0.5});
    return falling_block(1, ranks);
  };
  const Course one = course_on(1, make, 8);
  std::string bytes;
  Particles then;
  on_ranks(3, make, [&](FluidSolver& fluid) {
    course_of(fluid, 4);
    bytes = saved(fluid);
    then = course_of(fluid, 4).particles;
    const std::vector<RankShare> shares = fluid.shares();
    for (const std::size_t rank : {1u, 2u})
      EXPECT_NEAR(static_cast<double>(shares[rank].particles),
                  (rank == 1 ? 0.25 : 0.5) * static_cast<double>(shares[0].particles), 100);
    for (const RankShare& share : shares) EXPECT_GT(share.own_seconds, 0);
  });
  EXPECT_LT(difference(then, one.particles), 2e-3);
  on_ranks(3, make, [&](FluidSolver& fluid) {
    restore(fluid, bytes);
    EXPECT_EQ(course_of(fluid, 4).particles.position, then.position);
  });
}

TEST(Ranks, KeepTheirSharesAmongThemselves) {
  RankBoard board(3);
  ThreadRanks ranks(board, 1);
  EXPECT_EQ(ranks.share_of(0, 3), 3);
  EXPECT_TRUE(ranks.part(1)->shares().empty());
  ranks.set_shares({8, 4, 1});
  EXPECT_EQ(ranks.shares(), (std::vector<double>{1, 0.5, 0.125}));
  EXPECT_EQ(ranks.share_of(1, 2), 0.625);
  EXPECT_EQ(ranks.part(1)->shares(), (std::vector<double>{1, 0.25}));
}

// Single precision rounds by 6e-8.
TEST(Ranks, KeepMomentum) {
  on_ranks(4, spinning_drop, [](FluidSolver& fluid) {
    const Particles before = fluid.particles(), after = course_of(fluid, 50).particles;
    const double mass = static_cast<double>(before.size());
    EXPECT_LT((momentum(after) - momentum(before)).norm(), 1e-6 * mass);
    EXPECT_LT((angular_momentum(after) - angular_momentum(before)).norm(), 1e-6 * mass);
  });
}

// Whatever the solver leaves of the error: what each body lacks is found for it alone, and for all of it.
TEST(Ranks, KeepTheMomentumOfEachBody) {
  const Bodies bodies;
  const auto make = [&](Ranks* ranks) {
    FluidOptions o = options(5);
    o.gravity.setZero();
    return FluidSolver(o, bodies.points, bodies.velocity, {}, {}, {}, {}, {}, ranks);
  };
  const auto part_of = [&](const Particles& all, std::size_t body) {
    Particles part;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (bodies.body[all.id[i]] == body)
        part.position.push_back(all.position[i]), part.velocity.push_back(all.velocity[i]);
    return part;
  };
  for (const int size : {2, 3, 4, 7})
    on_ranks(size, make, [&](FluidSolver& fluid) {
      const Particles before = fluid.particles(), after = course_of(fluid, 6).particles;
      for (std::size_t body = 0; body <= bodies.body.back(); ++body) {
        const Particles then = part_of(before, body), now = part_of(after, body);
        const double lost =
            (momentum(now) - momentum(then)).norm() + (angular_momentum(now) - angular_momentum(then)).norm();
        EXPECT_LT(lost, 2e-6 * static_cast<double>(now.position.size())) << size << " ranks, " << body;
      }
    });
}

TEST(Ranks, MakeAndTakeParticlesAsOneDoes) {
  std::vector<std::size_t> taken;
  on_ranks(1, stream, [&](FluidSolver& fluid) {
    course_of(fluid, 60);
    taken = fluid.taken();
  });
  on_ranks(3, stream, [&](FluidSolver& fluid) {
    const Particles after = course_of(fluid, 60).particles;
    const std::vector<std::size_t> now = fluid.taken();
    EXPECT_EQ(now.size(), 2u);
    EXPECT_GT(now[0], 100u);
    for (std::size_t region = 0; region < 2; ++region)
      EXPECT_NEAR(static_cast<double>(now[region]), static_cast<double>(taken[region]), 2) << region;
    EXPECT_EQ(after.size(), fluid.size());
    EXPECT_EQ(fluid.sources(), std::vector<int>(after.size(), 4));
  });
}

/// A block with a number of its own for each particle, beside a stream; an outflow takes from both.
constexpr int kFirstSource = 1000;
FluidSolver numbered_block(Ranks* ranks) {
  FluidOptions o = options(0.01);
  test::add_stream(o);
  const auto points = test::block({-0.4, 0.5, -0.2}, {0.3, 0.8, 0.2}, kSpacing);
  std::vector<int> source(points.size());
  std::iota(source.begin(), source.end(), kFirstSource);
  return {o, points, std::vector<Vec3>(points.size(), Vec3(2, 0, 0)), {}, {}, source, {}, {}, ranks};
}

/// Whether each particle has its source, and the number of all that were made is known.
void expect_numbered(const FluidSolver& fluid) {
  const int in_block = 14 * 6 * 8, of_stream = 4;
  const Particles now = fluid.particles();
  const std::vector<int> sources = fluid.sources();
  ASSERT_EQ(sources.size(), now.size());
  for (std::size_t i = 0; i < now.size(); ++i) {
    const int id = static_cast<int>(now.id[i]);
    ASSERT_EQ(sources[i], id < in_block ? kFirstSource + id : of_stream);
  }
  const std::vector<std::size_t> taken = fluid.taken();
  const std::size_t made = std::accumulate(taken.begin(), taken.end(), now.size());
  EXPECT_EQ(now.id.back() + 1, static_cast<std::int64_t>(made)) << "the last one is still in the nozzle";
}

TEST(Ranks, ParticlesTakeTheirSourcesAlong) {
  std::string bytes;
  std::vector<std::size_t> taken;
  on_ranks(3, numbered_block, [&](FluidSolver& fluid) {
    course_of(fluid, 20);
    expect_numbered(fluid);
    taken = fluid.taken();
    bytes = saved(fluid);
  });
  EXPECT_GT(taken[0], 50u);
  for (const int ranks : {1, 2, 4})
    on_ranks(ranks, numbered_block, [&](FluidSolver& fluid) {
      restore(fluid, bytes);
      EXPECT_EQ(fluid.taken(), taken) << ranks;
      EXPECT_EQ(saved(fluid).size(), bytes.size()) << ranks;
      course_of(fluid, 10);
      EXPECT_GT(fluid.taken()[0], taken[0]) << ranks;
      expect_numbered(fluid);
    });
}

TEST(Ranks, EachGetsWhatIsForIt) {
  constexpr int kRanks = 5;
  RankBoard board(kRanks);
  std::vector<std::jthread> threads;
  for (int rank = 0; rank < kRanks; ++rank)
    threads.emplace_back([&, rank] {
      ThreadRanks ranks(board, rank);
      std::vector<std::vector<int>> sent(kRanks);
      for (int to = 0; to < kRanks; ++to) sent[to].assign(rank * to, 10 * rank + to);
      const std::vector<std::vector<int>> received = swapped(ranks, sent);
      for (int from = 0; from < kRanks; ++from)
        EXPECT_EQ(received[from], std::vector<int>(from * rank, 10 * from + rank));
    });
}

TEST(Ranks, GoOnWithWhatAnotherNumberOfThemHasSaved) {
  const auto make = [](Ranks* ranks) { return falling_block(1e-3, ranks); };
  std::string bytes;
  Particles then;
  on_ranks(4, make, [&](FluidSolver& fluid) {
    course_of(fluid, 3);
    bytes = saved(fluid);
    then = course_of(fluid, 3).particles;
  });
  for (const int ranks : {1, 2, 4})
    on_ranks(ranks, make, [&](FluidSolver& fluid) {
      restore(fluid, bytes);
      EXPECT_EQ(fluid.steps(), 3u);
      const Particles again = course_of(fluid, 3).particles;
      if (ranks == 4)
        EXPECT_EQ(again.position, then.position) << "as if never stopped";
      else
        EXPECT_LT(difference(again, then), 2e-3) << ranks;
    });
}

// Hot liquid beside cold one, two fluids of which one thickens where it is sheared.
TEST(Ranks, ConductHeatAndShearAsOneDoes) {
  const auto make = [](Ranks* ranks) {
    FluidOptions o = options(1e-2);
    o.more_viscosities = {0.1};
    o.more_densities = {500};
    o.rheologies = {HerschelBulkley{.consistency = 1e-2, .index = 1.5}};
    o.heat.emplace();
    o.heat->fluids = {{.specific_heat = 1, .conductivity = 100}, {.specific_heat = 2, .conductivity = 50}};
    const auto points = test::block({0, 0.05, 0}, {0.9, 0.45, 0.4}, kSpacing);
    std::vector<Vec3> velocity;
    std::vector<std::uint8_t> fluid;
    std::vector<double> temperature;
    for (const Vec3& x : points) {
      velocity.emplace_back(std::sin(5 * x.y()), 0, 0);
      fluid.push_back(x.y() > 0.25);
      temperature.push_back(300 + 100 * x.x());
    }
    return FluidSolver(o, points, velocity, {}, fluid, {}, temperature, {}, ranks);
  };
  std::vector<double> of_one;
  Course one;
  for (const int ranks : {1, 3})
    on_ranks(ranks, make, [&](FluidSolver& fluid) {
      const Course course = course_of(fluid, 5);
      const std::vector<double> temperature = fluid.temperatures();
      if (ranks == 1) one = course, of_one = temperature;
      EXPECT_LT(difference(course.particles, one.particles), 2e-3);
      EXPECT_NEAR(course.viscosity, one.viscosity, 0.1 * one.viscosity + 2);
      for (std::size_t i = 0; i < temperature.size(); ++i) EXPECT_NEAR(temperature[i], of_one[i], 0.05);
    });
}

// Lava: a block with a yield stress, thinner where it is hot, cools in air on a hot floor that carries it
// along.
TEST(Ranks, CoolAndYieldOnAMovingWallAsOneDoes) {
  const auto make = [](Ranks* ranks) {
    FluidOptions o = options(1);
    o.rheologies = {HerschelBulkley{.yield_stress = 1, .consistency = 1, .index = 0.7}};
    o.temperature_laws = {Arrhenius{.activation_energy = 5e4, .reference_temperature = 1400}};
    o.heat.emplace();
    o.heat->temperature = 1400;
    o.heat->fluids = {{.specific_heat = 1, .conductivity = 100}};
    o.heat->walls = {{WallHeat::Kind::temperature, 1600}};
    o.heat->convection = 5;
    o.heat->emissivity = 0.1;
    BodyMotion motion;
    motion.keys = {{0, Vec3(1, 0, 0), 0}};
    const std::vector<TriangleSurface> floor{test::box_surface({-1, -0.3, -1}, {2, 0, 2})};
    const auto points = test::block({0, 0.025, 0}, {0.9, 0.325, 0.6}, kSpacing);
    return FluidSolver(o, points, std::vector<Vec3>(points.size(), Vec3::Zero()),
                       solid_walls(floor, std::vector{motion}), {}, {}, {}, {}, ranks);
  };
  std::map<int, Course> course;
  std::map<int, std::vector<double>> temperature;
  for (const int ranks : {1, 2, 3})
    on_ranks(ranks, make, [&](FluidSolver& fluid) {
      course[ranks] = course_of(fluid, 8);
      temperature[ranks] = fluid.temperatures();
    });
  const auto temperature_difference = [&](int a, int b) {
    double square = 0;
    for (std::size_t i = 0; i < temperature[a].size(); ++i)
      square += std::pow(temperature[a][i] - temperature[b][i], 2);
    return std::sqrt(square / static_cast<double>(temperature[a].size()));
  };
  EXPECT_LT(difference(course[2].particles, course[1].particles), 2e-3);
  EXPECT_LT(difference(course[2].particles, course[3].particles), 2e-4);
  EXPECT_LT(temperature_difference(2, 1), 0.2) << "of 200 K";
  EXPECT_LT(temperature_difference(2, 3), 0.02) << "of 200 K";
  EXPECT_NEAR(course[2].viscosity, course[1].viscosity, 0.1 * course[1].viscosity + 2);
  const auto [coldest, hottest] = std::ranges::minmax(temperature[2]);
  EXPECT_LT(coldest, 1399);
  EXPECT_GT(hottest, 1401);
  EXPECT_GT(momentum(course[2].particles).x(), 1) << "carried along";
}

// Two boxes, one light and one heavy, in thin and in thick liquid that moves past them: each touches liquid
// of several ranks.
TEST(Ranks, MoveBodiesAsOneDoes) {
  for (const double viscosity : {1e-3, 10.0}) {
    std::vector<RigidBody> bodies;
    for (const double x : {0.1, 0.6}) {
      const TriangleSurface box = test::box_surface({x, 0.2, 0.1}, {x + 0.2, 0.4, 0.4});
      bodies.push_back({SolidWall(box), (x < 0.5 ? 300 : 3000) * 0.012});
    }
    const auto make = [&](Ranks* ranks) {
      std::vector<Vec3> points;
      for (const Vec3& x : test::block({0, 0, 0}, {1, 0.5, 0.5}, kSpacing))
        if (nearest_of_walls(all_solids({}, bodies), x).distance > 0.499 * kSpacing) points.push_back(x);
      const std::vector<Vec3> velocity(points.size(), Vec3(0.5, 0, 0.2));
      return FluidSolver(options(viscosity), points, velocity, {}, {}, {}, {}, bodies, ranks);
    };
    std::map<int, Course> course;
    std::map<int, std::vector<BodyState>> states;
    std::string bytes;
    for (const int ranks : {1, 2, 3})
      on_ranks(ranks, make, [&](FluidSolver& fluid) {
        course_of(fluid, 4);
        bytes = saved(fluid);
        restore(fluid, bytes);
        course[ranks] = course_of(fluid, 4);
        states[ranks] = fluid.bodies();
      });
    EXPECT_LT(difference(course[2].particles, course[1].particles), 5e-4) << viscosity;
    EXPECT_LT(difference(course[2].particles, course[3].particles), 1e-5) << viscosity;
    for (std::size_t b = 0; b < 2; ++b) {
      const auto difference_to = [&](int ranks) {
        return (states[2][b].velocity.linear - states[ranks][b].velocity.linear).norm();
      };
      EXPECT_LT(difference_to(1), 1e-4) << viscosity;
      EXPECT_LT(difference_to(3), 1e-5) << viscosity;
    }
  }
}

TEST(Ranks, AllFindThatTheLiquidFails) {
  const auto make = [](Ranks* ranks) {
    FluidOptions o = options(0);
    o.min_time_step = o.max_time_step = 1e-3;
    const auto points = test::block({0, 0, 0}, {0.5, 0.5, 0.5}, kSpacing);
    std::vector<Vec3> velocity(points.size(), Vec3::Zero());
    velocity[7] = Vec3(1e4, 0, 0);
    return FluidSolver(o, points, velocity, {}, {}, {}, {}, {}, ranks);
  };
  std::string of_one;
  for (const int ranks : {1, 3})
    on_ranks(ranks, make, [&](FluidSolver& fluid) {
      try {
        fluid.step(1);
        ADD_FAILURE() << "it went on";
      } catch (const SolverFailure& failure) {
        if (ranks == 1) of_one = failure.what();
        EXPECT_EQ(failure.what(), of_one);
        EXPECT_NE(of_one.find("particle 7 "), std::string::npos) << of_one;
      }
      EXPECT_EQ(fluid.particles().size(), 1000u) << "to look at";
    });
}

}  // namespace
}  // namespace kappaflow
