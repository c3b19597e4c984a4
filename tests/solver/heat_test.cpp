// Heat against exact solutions, what conducts nothing, and what must not change.
#include "solver/heat.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "core/errors.h"
#include "solver/fluid_solver.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

constexpr double kStefanBoltzmann = 5.670374419e-8;

/// So thick that it does not move.
FluidOptions still(double spacing) {
  FluidOptions o;
  o.spacing = spacing;
  o.kinematic_viscosity = 1e4;
  o.gravity = Vec3::Zero();
  o.heat = HeatOptions{.temperature = 300, .fluids = {{4000, 4e4}}, .ambient_temperature = 300};  // 1e-2 m2/s
  return o;
}

struct Slab {
  Slab(const FluidOptions& options, const std::vector<double>& temperature = {})
      : points(test::block({0, 0, 0}, {1, 1, 1}, options.spacing)),
        solver(options, points, std::vector<Vec3>(points.size(), Vec3::Zero()),
               solid_walls(std::vector{test::box_surface({-1, -0.5, -1}, {2, 0, 2}),
                                       test::box_surface({-1, 1, -1}, {2, 1.5, 2})}),
               {}, {}, temperature) {}

  void advance(double time) {
    while (solver.time() < time - 1e-12) {
      const FluidStep step = solver.step(time - solver.time());
      from_walls += step.heat_from_walls;
      from_air += step.heat_from_air;
    }
  }

  std::vector<Vec3> points;
  FluidSolver solver;
  double from_walls = 0, from_air = 0;
};

/// Of all liquid [J].
double heat(const FluidSolver& solver, const FluidOptions& o) {
  const std::vector<double> t = solver.temperatures();
  return std::accumulate(t.begin(), t.end(), 0.0) * o.density * o.heat->fluids[0].specific_heat *
         std::pow(o.spacing, 3);
}

/// Far from the open sides, beside which fewer neighbours conduct.
bool is_inside(const Vec3& x) {
  return std::abs(x.x() - 0.5) < 0.2 && std::abs(x.z() - 0.5) < 0.2;
}

/// Largest difference between the temperatures and those expected there [K].
template <class Expected>
double largest_error(const FluidSolver& solver, const std::vector<Vec3>& points, const Expected& expected) {
  const std::vector<double> t = solver.temperatures();
  double largest = 0;
  for (std::size_t i = 0; i < t.size(); ++i)
    if (is_inside(points[i])) largest = std::max(largest, std::abs(t[i] - expected(points[i].y())));
  return largest;
}

double half_space_error(double spacing) {
  FluidOptions o = still(spacing);
  o.max_time_step = 0.1 * spacing;  // so that the error in time shrinks with that in space
  o.heat->walls = {{WallHeat::Kind::temperature, 400}};
  Slab slab(o);
  constexpr double kTime = 1;  // the heat has come 0.2 m far
  slab.advance(kTime);
  return largest_error(slab.solver, slab.points,
                       [](double y) { return 300 + 100 * std::erfc(y / 2 / std::sqrt(1e-2 * kTime)); }) /
         100;
}

TEST(Heat, EntersAHalfSpaceAsTheErrorFunctionSays) {
  const double coarse = half_space_error(0.1), fine = half_space_error(0.05);
  RecordProperty("coarse", std::to_string(coarse));
  RecordProperty("fine", std::to_string(fine));
  EXPECT_LT(coarse, 0.08);
  EXPECT_LT(fine, coarse / 2.5);
}

TEST(Heat, BetweenTwoWallsBecomesLinear) {
  FluidOptions o = still(0.1);
  o.heat->walls = {{WallHeat::Kind::temperature, 280}, {WallHeat::Kind::temperature, 330}};
  o.heat->fluids[0].conductivity = 4e7;  // one step of implicit Euler crosses the slab
  Slab slab(o);
  slab.advance(0.5);
  EXPECT_LT(largest_error(slab.solver, slab.points, [](double y) { return 280 + 50 * y; }), 0.5);
}

TEST(Heat, CrossesTheJumpOfTwoConductivitiesWithoutLoss) {
  FluidOptions o = still(0.05);
  o.more_viscosities = {o.kinematic_viscosity};
  o.heat->fluids = {{4000, 8e7}, {1000, 1e7}};  // below and above
  o.heat->walls = {{WallHeat::Kind::temperature, 300}, {WallHeat::Kind::temperature, 400}};
  const std::vector<Vec3> points = test::block({0, 0, 0}, {1, 1, 1}, o.spacing);
  std::vector<std::uint8_t> fluid;
  for (const Vec3& x : points) fluid.push_back(x.y() > 0.5);
  FluidSolver solver(o, points, std::vector<Vec3>(points.size(), Vec3::Zero()),
                     solid_walls(std::vector{test::box_surface({-1, -0.5, -1}, {2, 0, 2}),
                                             test::box_surface({-1, 1, -1}, {2, 1.5, 2})}),
                     fluid);
  while (solver.time() < 0.2) solver.step(0.2 - solver.time());
  const double middle = 300 + 100.0 / 9;  // 8 (T - 300) = 400 - T
  EXPECT_LT(largest_error(solver, points,
                          [&](double y) {
                            return y < 0.5 ? 300 + (middle - 300) * 2 * y
                                           : middle + (400 - middle) * (2 * y - 1);
                          }),
            1);
}

TEST(Heat, WallsGiveTheFluxThatTheyAreSaidTo) {
  FluidOptions o = still(0.1);
  o.heat->walls = {{WallHeat::Kind::insulated, 0}, {WallHeat::Kind::flux, 5e4}};
  Slab slab(o);
  const double before = heat(slab.solver, o);
  slab.advance(1);
  EXPECT_NEAR(slab.from_walls, 5e4, 0.03 * 5e4);
  EXPECT_NEAR(heat(slab.solver, o) - before, slab.from_walls, 1e-9 * before);
}

TEST(Heat, TakenBelowAbsoluteZeroIsAFailure) {
  FluidOptions o = still(0.1);
  o.heat->walls = {{WallHeat::Kind::flux, -1e10}};
  Slab slab(o);
  EXPECT_THROW(slab.advance(1), SolverFailure);
}

TEST(Heat, IsKeptInLiquidThatMovesWithoutIt) {
  FluidOptions o = still(0.1);
  o.gravity = {3, -9.81, 0};
  o.kinematic_viscosity = 1e-3;
  o.heat->fluids[0].conductivity = 1e5;
  std::vector<double> temperature;
  for (std::size_t i = 0; i < 1000; ++i)
    temperature.push_back(300 + 100 * std::sin(static_cast<double>(7 * i)));
  Slab slab(o, temperature);
  const double before = heat(slab.solver, o);
  slab.advance(0.3);
  EXPECT_NEAR(heat(slab.solver, o), before, 1e-12 * before);
  EXPECT_EQ(slab.from_walls, 0);
  EXPECT_EQ(slab.from_air, 0);
  for (const double t : slab.solver.temperatures()) {
    EXPECT_GE(t, 200);
    EXPECT_LE(t, 400);
  }
}

TEST(Heat, OfTheStiffestMetalStaysBetweenTheWallsTemperatures) {
  FluidOptions o = still(0.1);
  o.heat->fluids[0].conductivity = 1e12;  // k dt / (rho c h^2) = 1e5
  o.heat->walls = {{WallHeat::Kind::temperature, 280}, {WallHeat::Kind::temperature, 330}};
  Slab slab(o);
  slab.advance(o.max_time_step);
  for (const double t : slab.solver.temperatures()) {
    EXPECT_GE(t, 280);
    EXPECT_LE(t, 330);
  }
}

/// A cube of liquid in the air.
struct Cube {
  explicit Cube(const FluidOptions& options)
      : points(test::block({0, 0, 0}, {1, 1, 1}, options.spacing)),
        solver(options, points, std::vector<Vec3>(points.size(), Vec3::Zero()), {}) {}

  /// Of the free surface as the solver sees it [m2].
  double area(const FluidOptions& o) const {
    double sum = 0;
    for (const float density : solver.densities())
      sum += static_cast<double>(free_area(density / 1000, static_cast<float>(o.spacing))) *
             std::pow(o.spacing, 3);
    return sum;
  }
  double mean() const {
    const std::vector<double> t = solver.temperatures();
    return std::accumulate(t.begin(), t.end(), 0.0) / static_cast<double>(t.size());
  }

  std::vector<Vec3> points;
  FluidSolver solver;
};

TEST(Heat, IsLostToTheAirAtNewtonsRate) {
  FluidOptions o = still(0.1);
  o.heat->fluids[0].conductivity = 1e9;  // the cube has one temperature
  o.heat->temperature = 400;
  o.heat->convection = 4e4;
  Cube cube(o);
  const double area = cube.area(o);
  EXPECT_NEAR(area, 6, 0.15 * 6);
  double from_air = 0;
  while (cube.solver.time() < 10) from_air += cube.solver.step(10 - cube.solver.time()).heat_from_air;
  EXPECT_NEAR(cube.mean() - 300, 100 * std::exp(-area * 4e4 * 10 / 4e6), 0.2);
  EXPECT_NEAR(from_air, (cube.mean() - 400) * 4e6, 1e-12 * 400 * 4e6);
}

TEST(Heat, IsRadiatedAsStefanAndBoltzmannSay) {
  FluidOptions o = still(0.1);
  o.heat->fluids[0] = {1, 1e9};  // 1000 J/K
  o.heat->temperature = 1500;
  o.heat->ambient_temperature = 1;
  o.heat->emissivity = 0.8;
  Cube cube(o);
  const double area = cube.area(o);
  while (cube.solver.time() < 1) cube.solver.step(1 - cube.solver.time());
  const double cubed = std::pow(1500, -3) + 3 * 0.8 * kStefanBoltzmann * area / 1000;
  EXPECT_NEAR(cube.mean(), std::pow(cubed, -1.0 / 3), 5);  // it has lost 500 K
  EXPECT_LT(std::pow(cubed, -1.0 / 3), 1000);
}

TEST(Heat, FreeAreaIsThatOfTheFacesWithoutNeighbours) {
  const float h = 0.1f;
  EXPECT_EQ(free_area(1, h), 0);
  EXPECT_EQ(free_area(1.1f, h), 0);
  EXPECT_EQ(free_area(0.97f, h), 0);
  EXPECT_NEAR(free_area(5.0f / 6, h), 1 / h, 1e-4f);               // a plane surface
  EXPECT_NEAR(free_area(4.0f / 6, h), 2 / h, 1e-4f);               // a sheet
  EXPECT_NEAR(free_area(0.318f, h), 4.84f / h, 0.2f * 4.84f / h);  // a drop of one particle
}

TEST(Heat, IsTheSameWithAnyNumberOfThreads) {
  const auto run = [](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    FluidOptions o = still(0.05);
    o.gravity = {3, -9.81, 0};
    o.kinematic_viscosity = 1e-2;
    o.temperature_laws = {Arrhenius{1e5, 300}};
    o.heat->walls = {{WallHeat::Kind::temperature, 400}, {WallHeat::Kind::flux, 1e4}};
    o.heat->convection = 100;
    Slab slab(o);
    slab.advance(0.1);
    return slab.solver.temperatures();
  };
  const std::vector<double> one = run(1);
  for (const std::size_t threads : {2, 4}) EXPECT_EQ(one, run(threads)) << threads;
}

TEST(Heat, ComesWithTheLiquidOfEmitters) {
  FluidOptions o = still(0.1);
  Emitter emitter;
  emitter.mouth = RectangleMouth{0.3, 0.3, {0, 0, 1}};
  emitter.speed = 1;
  o.kinematic_viscosity = 1e-3;
  emitter.temperature = 350;
  o.emitters = {emitter};
  emitter.temperature.reset();
  emitter.position = {5, 0, 0};
  o.emitters.push_back(emitter);
  FluidSolver solver(o, {}, {}, {});
  while (solver.time() < 1) solver.step(1 - solver.time());
  const std::vector<double> t = solver.temperatures();
  const std::vector<Vec3> x = solver.particles().position;
  ASSERT_GT(t.size(), 100);
  for (std::size_t i = 0; i < t.size(); ++i) EXPECT_NEAR(t[i], x[i].x() > 2.5 ? 300 : 350, 1e-9);
}

TEST(Heat, RefusesWhatIsOutOfRange) {
  const std::vector<Vec3> one(1, Vec3::Zero());
  const auto refused = [&](const FluidOptions& o, const std::vector<double>& temperature = {}) {
    EXPECT_THROW(FluidSolver(o, one, one, {}, {}, {}, temperature), InvalidInput);
  };
  FluidOptions o = still(0.1);
  EXPECT_NO_THROW(FluidSolver(o, one, one, {}, {}, {}, std::vector{310.0}));
  refused(o, {310.0, 320.0});
  refused(o, {-1.0});
  const auto with = [&](auto&& change) {
    FluidOptions changed = o;
    change(changed);
    refused(changed);
  };
  with([](FluidOptions& c) { c.heat->temperature = 0; });
  with([](FluidOptions& c) { c.heat->emissivity = 1.1; });
  with([](FluidOptions& c) { c.heat->convection = -1; });
  with([](FluidOptions& c) { c.heat->fluids.clear(); });
  with([](FluidOptions& c) { c.heat->fluids[0].specific_heat = 0; });
  with([](FluidOptions& c) { c.heat->fluids[0].conductivity = -1; });
  with([](FluidOptions& c) { c.heat->walls = {{WallHeat::Kind::temperature, 0}}; });
  with([](FluidOptions& c) { c.temperature_laws = {Arrhenius{1e5, 0}}; });
  with([](FluidOptions& c) { c.temperature_laws = {VogelFulcherTammann{4000, 900, 800}}; });
  o.heat.reset();
  refused(o, {310.0});
  o.temperature_laws = {Arrhenius{1e5, 300}};
  refused(o);
}

// exp(E / R (1 / 250 - 1 / 300)) by hand; B / 500 - B / 900 for Vogel's law.
TEST(TemperatureLaw, FollowsTheFormulas) {
  EXPECT_NEAR(shift_factor(Arrhenius{5e4, 300}, 250),
              std::exp(5e4 / 8.31446261815324 * (1.0 / 250 - 1.0 / 300)), 1e-9);
  EXPECT_NEAR(shift_factor(VogelFulcherTammann{1000, 500, 1400}, 1000), std::exp(1000.0 / 500 - 1000.0 / 900),
              1e-12);
  EXPECT_EQ(shift_factor(VogelFulcherTammann{1000, 500, 1400}, 1400), 1);
  EXPECT_EQ(shift_factor(Arrhenius{5e4, 300}, 300), 1);
  EXPECT_EQ(shift_factor(TemperatureLaw(), 10), 1);
  EXPECT_EQ(shift_factor(VogelFulcherTammann{1000, 500, 1400}, 400), kMostShift);
  EXPECT_EQ(shift_factor(VogelFulcherTammann{1000, 500, 1400}, 501), kMostShift);
}

/// Where a block on a plate is after half a second, sheared by its weight.
std::vector<Vec3> sheared(FluidOptions o) {
  o.gravity = {6, -9.81, 0};
  o.viscosity_tolerance = 1e-4;
  const std::vector<Vec3> points = test::block({0, 0, 0}, {0.6, 0.4, 0.6}, o.spacing);
  FluidSolver solver(o, points, std::vector<Vec3>(points.size(), Vec3::Zero()),
                     solid_walls(std::vector{test::box_surface({-3, -0.5, -3}, {6, 0, 3})}));
  while (solver.time() < 0.5) solver.step(0.5 - solver.time());
  return solver.particles().position;
}

double largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

TEST(TemperatureLaw, ColdLiquidIsAsThickAsItSays) {
  FluidOptions cold = still(0.1), thick = cold;
  cold.kinematic_viscosity = 0.02;
  cold.temperature_laws = {Arrhenius{5e4, 350}};
  thick.kinematic_viscosity = 0.02 * shift_factor(cold.temperature_laws[0], 300);
  const std::vector<Vec3> found = sheared(cold);
  EXPECT_LT(largest_distance(found, sheared(thick)), 1e-3);
  thick.kinematic_viscosity *= 1.1;
  EXPECT_GT(largest_distance(found, sheared(thick)), 5e-3);
}

// k g^n of the shifted law is k (a g)^n, and its regularisation a m.
TEST(TemperatureLaw, ShiftsTheShearRate) {
  FluidOptions cold = still(0.1), thick = cold;
  cold.rheologies = {HerschelBulkley{0.05, 0.1, 0.5, 10}};
  cold.temperature_laws = {Arrhenius{2e4, 350}};
  const double a = shift_factor(cold.temperature_laws[0], 300);
  thick.rheologies = {HerschelBulkley{0.05, 0.1 * std::sqrt(a), 0.5, 10 * a}};
  const std::vector<Vec3> found = sheared(cold);
  EXPECT_LT(largest_distance(found, sheared(thick)), 4e-3);  // their pressures begin in other ways
  cold.temperature_laws.clear();
  EXPECT_GT(largest_distance(found, sheared(cold)), 2e-2);
}

}  // namespace
}  // namespace kappaflow
