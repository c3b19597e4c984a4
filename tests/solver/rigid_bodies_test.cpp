// Rigid bodies: alone, on walls, and moved by the liquid that they move.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/errors.h"
#include "solver/body_collisions.h"
#include "solver/fluid_solver.h"
#include "solver/pressure.h"
#include "solver/viscosity.h"
#include "solver/wall_bodies.h"
#include "tests/solver/dense_system.h"
#include "tests/solver/shapes.h"

namespace kappaflow {
namespace {

constexpr double kSpacing = 0.05;

RigidBody box_body(const Vec3& lower, const Vec3& upper, double density) {
  return {SolidWall(test::box_surface(lower, upper)), density * (upper - lower).prod()};
}

/// A lattice in the box, without what is in the body or within half a spacing of it.
std::vector<Vec3> liquid_around(std::span<const RigidBody> bodies, const Vec3& lower, const Vec3& upper,
                                double spacing) {
  const std::vector<SolidWall> solids = all_solids({}, bodies);
  std::vector<Vec3> points;
  for (const Vec3& x : test::block(lower, upper, spacing))
    if (nearest_of_walls(solids, x).distance > 0.499 * spacing) points.push_back(x);
  return points;
}

/// A body amid irregular liquid, as FluidSolver prepares them for a step.
struct Immersed {
  explicit Immersed(const RigidBody& body)
      : bodies({&body, 1}, 1000, kSpacing),
        walls(wall_bodies({}, {}, {&body, 1}, kSpacing), static_cast<float>(kSpacing)),
        search(static_cast<float>(kSpacing)) {
    std::vector<Vec3> points;
    for (const Vec3& x : test::blob(0.4, kSpacing))
      if (body.solid.solids().front().nearest(x).distance > 0.4 * kSpacing) points.push_back(x);
    std::vector<Vec3> velocity;
    for (const Vec3& x : points)
      velocity.emplace_back(std::sin(20 * x.y()), std::cos(30 * x.z()), 0.3 - 5 * x.x() * x.y());
    particles = particles_at_start(points, velocity);
    search.sort(particles);
    search.find(particles, lists);
    walls.add_to(particles, sums);
    bodies.find_contacts(particles, walls, sums);
  }

  RigidBodies bodies;
  Walls walls;
  NeighbourSearch search;
  NeighbourLists lists;
  FluidParticles particles;
  WallSums sums;
};

RigidBody slab() {
  RigidBody body = box_body({-0.2, -0.1, -0.1}, {0.15, 0.05, 0.1}, 700);
  body.velocity = {0.3, -0.5, 0.2};
  body.angular_velocity = {2, -1, 3};
  return body;
}

TEST(MassProperties, OfABoxAndOfTwo) {
  const Vec3 lower(0.1, -0.3, 2), upper(0.5, 0.4, 2.3), edge = upper - lower;
  const MassProperties m = mass_properties(test::box_surface(lower, upper));
  EXPECT_NEAR(m.volume, edge.prod(), 1e-14);
  EXPECT_LT((m.centre - (lower + upper) / 2).norm(), 1e-14);
  const Mat3 expected =
      ((edge.squaredNorm() * Vec3::Ones() - edge.cwiseAbs2()) / 12).asDiagonal().toDenseMatrix();
  EXPECT_LT((m.inertia - expected).norm(), 1e-14);

  // Side by side: by the parallel axis theorem.
  TriangleSurface two = test::box_surface({0, 0, 0}, {1, 1, 1});
  for (const Vec3& x : test::box_surface({2, 0, 0}, {3, 1, 1}).vertices) two.vertices.push_back(x);
  for (std::size_t t = 0; t < 12; ++t) {
    const auto [i, j, k] = two.triangles[t];
    two.triangles.push_back({i + 8, j + 8, k + 8});
  }
  const MassProperties pair = mass_properties(two);
  EXPECT_NEAR(pair.volume, 2, 1e-14);
  EXPECT_LT((pair.centre - Vec3(1.5, 0.5, 0.5)).norm(), 1e-14);
  EXPECT_LT((pair.inertia.diagonal() - Vec3(1. / 6, 1. / 6 + 1, 1. / 6 + 1)).norm(), 1e-14);
}

TEST(RigidBodies, RefuseWhatIsNoBody) {
  RigidBody body = slab();
  body.mass = 0;
  EXPECT_THROW(RigidBodies({&body, 1}, 1000, kSpacing), InvalidInput);
  body = slab();
  body.friction = -0.1;
  EXPECT_THROW(RigidBodies({&body, 1}, 1000, kSpacing), InvalidInput);
  body = slab();
  body.velocity.x() = std::nan("");
  EXPECT_THROW(RigidBodies({&body, 1}, 1000, kSpacing), InvalidInput);
  body = slab();
  const std::vector<Vec3> inside{{0, 0, 0}};
  FluidOptions o;
  o.spacing = kSpacing;
  EXPECT_THROW(FluidSolver(o, inside, inside, {}, {}, {}, {}, {&body, 1}), InvalidInput);
}

// A force that does no work on what moves is no force: kappa . D a = -a . M a for the bodies' part of both.
TEST(RigidBodies, WhatPressureDoesToThemIsWhatTheyDoToIt) {
  const RigidBody body = slab();
  Immersed all(body);
  FluidParticles& particles = all.particles;
  for (std::size_t i = 0; i < particles.size(); ++i)
    particles.position[i][3] = 1 + particles.position[i][0] + std::sin(50 * particles.position[i][1]);
  all.bodies.find_push(particles, all.sums);
  double work = 0, load = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double kappa = static_cast<double>(particles.position[i][3]);
    work += kappa * static_cast<double>(all.bodies.push_rate(i, particles, all.sums));
    load = std::max(load, kappa * kappa * static_cast<double>(all.bodies.push_diagonal(i, all.sums)));
  }
  EXPECT_GT(load, 0);
  EXPECT_NEAR(work, -all.bodies.push_square(), 1e-5 * all.bodies.push_square());

  // The diagonal: what the pressure of one particle does to its own density.
  const std::uint32_t one = all.bodies.contacts(0)[7].particle;
  for (std::size_t i = 0; i < particles.size(); ++i) particles.position[i][3] = i == one ? 1 : 0;
  all.bodies.find_push(particles, all.sums);
  EXPECT_NEAR(all.bodies.push_diagonal(one, all.sums), all.bodies.push_square(),
              1e-5 * all.bodies.push_square());
}

// However its contacts lie.
TEST(RigidBodies, TheSamePressureAllAroundMovesNothing) {
  const RigidBody body = slab();
  Immersed all(body);
  EXPECT_EQ(all.walls.wet_share(0), 1);
  for (Vec4f& x : all.particles.position) x[3] = 1;
  all.bodies.find_push(all.particles, all.sums);
  Immersed other(body);
  for (Vec4f& x : other.particles.position) x[3] = 1 + 10 * x[1];  // and a gradient does
  other.bodies.find_push(other.particles, other.sums);
  EXPECT_LT(all.bodies.push_square(), 1e-8 * other.bodies.push_square());
}

// The equations that BodyDrag takes apart, put together again.
TEST(RigidBodies, ViscositySolvesForLiquidAndBodiesAtOnce) {
  const RigidBody body = slab();
  Immersed all(body);
  FluidOptions o;
  o.spacing = kSpacing;
  o.kinematic_viscosity = 3;
  o.viscosity_tolerance = 1e-6;
  o.max_viscosity_iterations = 2000;
  const float dt = 0.01f;
  const std::vector<Vec4f> before = all.particles.velocity;
  const rigid::Vector6 momentum = all.bodies.mass(0) * all.bodies.motion(0);
  ViscositySolver solver(o);
  const ViscositySolve solve = solver.solve(all.particles, all.lists, all.sums, dt, 0, &all.bodies);
  EXPECT_LE(solve.error, 1);

  const ViscousForces forces(o);
  const rigid::Vector6 motion = all.bodies.motion(0);
  const std::vector<Vec4f>& v = all.particles.velocity;
  std::vector<Vec4f> left;
  solver.apply(all.particles, all.lists, all.sums, dt, v, left);  // of the body at rest
  rigid::Vector6 load = rigid::Vector6::Zero();
  for (const auto& [i, k] : all.bodies.contacts(0)) {
    const Vec3 arm = all.bodies.arm(0, i, all.particles);
    const Vec4f u = padded(rigid::velocity_at(motion, arm));
    left[i] -= dt * forces.contact_drag(i, k, all.particles, all.sums, u);
    const Vec4f drag = dt * forces.contact_drag(i, k, all.particles, all.sums, v[i] - u);
    load += rigid::load_of(drag.head<3>().cast<double>(), arm);
  }
  double error = 0, size = 0;
  for (std::size_t i = 0; i < v.size(); ++i) {
    error = std::max(error, static_cast<double>((left[i] - before[i]).norm()));
    size = std::max(size, static_cast<double>(before[i].norm()));
  }
  EXPECT_LT(error, 1e-3 * size);
  const rigid::Vector6 change = all.bodies.mass(0) * motion - momentum;
  EXPECT_GT(change.norm(), 0.1 * momentum.norm());
  EXPECT_LT((change - load).norm(), 1e-4 * change.norm());
}

struct Momenta {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  double energy = 0, speeds = 0, moments = 0;  // speeds, moments: sums of lengths
};

/// Of all; energy with gravity's.
Momenta momenta(const FluidSolver& solver, const RigidBody& body, const FluidOptions& o) {
  Momenta m;
  const auto add = [&](double mass, const Vec3& x, const Vec3& v) {
    m.linear += mass * v;
    m.angular += mass * x.cross(v);
    m.speeds += mass * v.norm();
    m.moments += mass * x.norm() * v.norm();
    m.energy += mass * (v.squaredNorm() / 2 - o.gravity.dot(x));
  };
  const Particles p = solver.particles();
  for (std::size_t i = 0; i < p.size(); ++i)
    add(o.density * std::pow(o.spacing, 3), p.position[i], p.velocity[i]);
  const BodyState state = solver.bodies().front();
  add(body.mass, state.velocity.point, state.velocity.linear);
  const Mat3 inertia = body.mass * state.pose.rotation * mass_properties(body.solid.surface()).inertia *
                       state.pose.rotation.transpose();
  const Vec3 spin = inertia * state.velocity.angular;
  m.angular += spin;
  m.energy += state.velocity.angular.dot(spin) / 2;
  return m;
}

TEST(RigidBodies, TogetherWithLiquidTheyKeepTheirMomentum) {
  for (const double density : {200.0, 5000.0}) {
    FluidOptions o;
    o.spacing = kSpacing;
    o.kinematic_viscosity = 0.05;
    o.gravity.setZero();
    RigidBody body = box_body({-0.15, -0.1, -0.1}, {0.15, 0.1, 0.1}, density);
    body.velocity = {0.2, 0.1, 0};
    body.angular_velocity = {0, 1, 2};
    std::vector<Vec3> points;
    for (const Vec3& x : test::blob(0.35, kSpacing))
      if (body.solid.solids().front().nearest(x).distance > 0.5 * kSpacing) points.push_back(x);
    FluidSolver solver(o, points, std::vector<Vec3>(points.size(), Vec3(-0.1, 0, 0.2)), {}, {}, {}, {},
                       {&body, 1});
    const Momenta before = momenta(solver, body, o);
    for (int k = 0; k < 300; ++k) solver.step(1e3);
    const Momenta after = momenta(solver, body, o);
    EXPECT_LT((after.linear - before.linear).norm(), 1e-5 * before.speeds) << density;
    EXPECT_LT((after.angular - before.angular).norm(), 1e-5 * before.moments) << density;
    EXPECT_LT(after.energy, before.energy) << density;
    EXPECT_LT((solver.bodies().front().velocity.linear - body.velocity).norm(), 1) << density;
    EXPECT_GT((solver.bodies().front().velocity.linear - body.velocity).norm(), 0.01) << density;
  }
}

// Unstable about the middle axis, so that it tumbles; its angular momentum does not.
TEST(RigidBodies, FreeOnesTumbleAsEulersEquationsSay) {
  RigidBody body = box_body({-0.4, -0.2, -0.1}, {0.4, 0.2, 0.1}, 1000);
  body.angular_velocity = {0.02, 3, -0.02};
  body.velocity = {1, 2, 3};
  RigidBodies bodies({&body, 1}, 1000, kSpacing);
  const Vec3 inertia = bodies.weight(0).inertia.diagonal();
  const rigid::Vector6 momentum = bodies.mass(0) * bodies.motion(0);
  // Euler's equations in the body's axes, by Runge and Kutta's method.
  Vec3 omega = body.angular_velocity;
  const auto rate = [&](const Vec3& w) -> Vec3 {
    return w.cwiseProduct(inertia).cross(w).cwiseQuotient(inertia);
  };
  const double dt = 1e-3;
  double largest = 0;
  for (int step = 0; step < 4000; ++step) {
    bodies.move(0, dt);
    const Vec3 a = rate(omega), b = rate(omega + dt / 2 * a), c = rate(omega + dt / 2 * b),
               d = rate(omega + dt * c);
    omega += dt / 6 * (a + 2 * b + 2 * c + d);
    const Vec3 own = bodies.state(0).pose.rotation.transpose() * bodies.motion(0).tail<3>();
    largest = std::max(largest, std::abs(own.x()));
    ASSERT_LT((own - omega).norm(), 0.05 * 3) << step;
  }
  EXPECT_GT(largest, 1) << "it does not tumble";
  EXPECT_LT((bodies.mass(0) * bodies.motion(0) - momentum).norm(), 1e-9 * momentum.norm());
  EXPECT_LT((bodies.state(0).velocity.point - 4 * body.velocity).norm(), 1e-9);
}

/// Moves bodies alone.
struct Alone {
  Alone(std::span<const RigidBody> described, std::span<const TriangleSurface> walls)
      : bodies(described, 1000, kSpacing), collisions(bodies, solid_walls(walls), kSpacing) {}

  void advance(double duration, const Vec3& gravity = {0, -9.81, 0}) {
    const double dt = 2e-3;
    for (const double end = time + duration; time < end - dt / 2; time += dt) {
      bodies.accelerate(gravity, dt);
      collisions.move(bodies, time, dt);
    }
  }
  Vec3 centre(std::size_t b = 0) const { return bodies.state(b).velocity.point; }
  Vec3 velocity(std::size_t b = 0) const { return bodies.state(b).velocity.linear; }
  double tilt(std::size_t b = 0) const {
    return std::acos(std::min(1.0, bodies.state(b).pose.rotation(1, 1)));
  }

  RigidBodies bodies;
  BodyCollisions collisions;
  double time = 0;
};

const std::vector<TriangleSurface> kFloor{test::box_surface({-3, -0.5, -3}, {3, 0, 3})};

TEST(BodyCollisions, BoxesComeToRestOnTheFloorAndOnEachOther) {
  const std::vector<RigidBody> boxes{box_body({-0.3, 0.1, -0.3}, {0.3, 0.4, 0.3}, 2000),
                                     box_body({-0.2, 0.5, -0.2}, {0.2, 0.7, 0.2}, 1000)};
  Alone all(boxes, kFloor);
  all.advance(2);
  EXPECT_NEAR(all.centre(0).y(), 0.15, 0.1 * kSpacing);
  EXPECT_NEAR(all.centre(1).y(), 0.4, 0.2 * kSpacing);
  for (const std::size_t b : {0, 1}) {
    EXPECT_LT(all.velocity(b).norm(), 2e-3);
    EXPECT_LT(all.tilt(b), 1e-2);
    EXPECT_LT(std::hypot(all.centre(b).x(), all.centre(b).z()), 0.02);
  }
}

// s = v^2 / (2 mu g)
TEST(BodyCollisions, FrictionIsCoulombs) {
  for (const double friction : {0.2, 0.6}) {
    RigidBody box = box_body({-0.3, 0, -0.3}, {0.3, 0.2, 0.3}, 1000);
    box.velocity = {2, 0, 0};
    box.friction = friction;
    Alone all({&box, 1}, kFloor);
    all.advance(1.5);
    EXPECT_LT(all.velocity().norm(), 2e-3);
    const double expected = 4 / (2 * friction * 9.81);
    EXPECT_NEAR(all.centre().x(), expected, 0.05 * expected) << friction;
    EXPECT_LT(all.tilt(), 1e-2);
  }
}

// What hits another gives it its momentum: no restitution, so that they go on together.
TEST(BodyCollisions, KeepMomentum) {
  std::vector<RigidBody> boxes{box_body({-0.5, -0.1, -0.1}, {-0.3, 0.1, 0.1}, 3000),
                               box_body({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}, 1000)};
  boxes[0].velocity = {1, 0, 0};
  Alone all(boxes, {});
  all.advance(1, Vec3::Zero());
  EXPECT_NEAR(all.velocity(0).x(), 0.75, 1e-3);
  EXPECT_NEAR(all.velocity(1).x(), 0.75, 1e-3);
  const Vec3 sum = boxes[0].mass * all.velocity(0) + boxes[1].mass * all.velocity(1);
  EXPECT_LT((sum - boxes[0].mass * boxes[0].velocity).norm(), 1e-9 * sum.norm());
}

/// Three boxes' length of an L, as one surface.
TriangleSurface bracket(double size, double thickness) {
  TriangleSurface s;
  const std::array<Vec2, 6> outline{
      Vec2(0, 0),   Vec2(size, 0), Vec2(size, thickness), Vec2(thickness, thickness), Vec2(thickness, size),
      Vec2(0, size)};
  for (const double z : {0.0, size})
    for (const Vec2& p : outline) s.vertices.emplace_back(p.x(), p.y(), z);
  for (const Triangle& t : {Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{0, 3, 4}, Triangle{0, 4, 5}}) {
    s.triangles.push_back({t[0], t[2], t[1]});
    s.triangles.push_back({t[0] + 6, t[1] + 6, t[2] + 6});
  }
  for (int i = 0; i < 6; ++i) {
    const int j = (i + 1) % 6;
    s.triangles.push_back({i, j, j + 6});
    s.triangles.push_back({i, j + 6, i + 6});
  }
  return s;
}

// A bracket holds a box in its inner corner, where its convex hull would have none.
TEST(BodyCollisions, OfWhatIsNotConvex) {
  const TriangleSurface surface = bracket(0.6, 0.2);
  const double volume = mass_properties(surface).volume;
  ASSERT_NEAR(volume, 0.2 * 0.6 * (0.6 + 0.4), 1e-12);
  std::vector<RigidBody> bodies{{SolidWall(surface), 1000 * volume},
                                box_body({0.25, 0.22, 0.2}, {0.45, 0.42, 0.4}, 1000)};
  Alone all(bodies, kFloor);
  all.advance(1);
  EXPECT_LT(all.velocity(1).norm(), 5e-3);
  EXPECT_NEAR(all.centre(1).y(), 0.3, 0.2 * kSpacing);
  EXPECT_NEAR(all.centre(0).y(), mass_properties(surface).centre.y(), 0.2 * kSpacing);
}

TEST(BodyCollisions, MovingWallsPushThem) {
  BodyMotion motion;
  motion.keys = {{0, {0.5, 0, 0}, 0}};
  const std::vector<SolidWall> walls{SolidWall(kFloor.front()),
                                     SolidWall(test::box_surface({-1, 0, -0.5}, {-0.5, 0.5, 0.5}), motion)};
  const RigidBody box = box_body({-0.3, 0, -0.2}, {0.1, 0.2, 0.2}, 1000);
  RigidBodies bodies({&box, 1}, 1000, kSpacing);
  BodyCollisions collisions(bodies, walls, kSpacing);
  const double dt = 2e-3;
  for (int k = 0; k < 1000; ++k) {
    bodies.accelerate({0, -9.81, 0}, dt);
    collisions.move(bodies, k * dt, dt);
  }
  EXPECT_NEAR(bodies.state(0).velocity.linear.x(), 0.5, 1e-2);
  EXPECT_NEAR(bodies.state(0).velocity.point.x(), -0.5 + 0.5 * 2 + 0.2, 0.1 * kSpacing);
}

// However fast: a step's way is a good part of a spacing, and the wall's surface where it is after the step.
TEST(BodyCollisions, FastWallsPushThemNoFurtherThanTheyGo) {
  BodyMotion motion;
  motion.keys = {{0, {0, -1, 0}, 0}};
  const double dt = 0.4 * kSpacing;
  const std::vector<SolidWall> walls{SolidWall(kFloor.front(), motion)};
  RigidBody box = box_body({-0.3, 0, -0.2}, {0.1, 0.2, 0.2}, 1000);
  box.velocity = {0, -1, 0};
  RigidBodies bodies({&box, 1}, 1000, kSpacing);
  BodyCollisions collisions(bodies, walls, kSpacing);
  for (int k = 0; k < 50; ++k) {
    bodies.accelerate({0, -9.81, 0}, dt);
    collisions.move(bodies, k * dt, dt);
  }
  EXPECT_NEAR(bodies.state(0).velocity.point.y() - 0.1 + 50 * dt, 0, 0.1 * kSpacing);
  EXPECT_NEAR(bodies.state(0).velocity.linear.y(), -1, 1e-2);
}

// Else honey around it would flow for ever, as around one that sinks.
TEST(RigidBodies, AHeavyOneRestsOnTheFloorInThickLiquid) {
  FluidOptions o;
  o.spacing = kSpacing;
  o.kinematic_viscosity = 10;
  const std::vector<RigidBody> body{box_body({0.35, 0, 0.35}, {0.65, 0.3, 0.65}, 7800)};
  const auto points = liquid_around(body, {0, 0, 0}, {1, 0.6, 1}, kSpacing);
  FluidSolver solver(o, points, std::vector<Vec3>(points.size(), Vec3::Zero()),
                     solid_walls(test::container(1, 1, 0.2)), {}, {}, {}, body);
  const double in_a_step = 9.81 * o.max_time_step;
  while (solver.time() < 1.5) solver.step(1.5 - solver.time());
  const BodyState state = solver.bodies().front();
  EXPECT_NEAR(state.velocity.point.y(), 0.15, 0.1 * kSpacing);
  EXPECT_LT(state.velocity.linear.norm(), 0.01 * in_a_step);
  const Particles p = solver.particles();
  double sum = 0;
  for (const Vec3& v : p.velocity) sum += v.norm();
  EXPECT_LT(sum / static_cast<double>(p.size()), 0.05 * in_a_step);
}

struct Afloat {
  static constexpr double kWidth = 1, kDepth = 0.4, kHeight = 0.2, kSide = 0.5;

  Afloat(double density, double speed) {
    o.spacing = kSpacing;
    o.kinematic_viscosity = 0.02;
    const double bottom = kDepth - density / o.density * kHeight, a = (kWidth - kSide) / 2, b = kWidth - a;
    body.push_back(box_body({a, bottom, a}, {b, bottom + kHeight, b}, density));
    body.front().velocity.y() = speed;
    const auto points = liquid_around(body, {0, 0, 0}, {kWidth, kDepth, kWidth}, kSpacing);
    volume = static_cast<double>(points.size()) * std::pow(kSpacing, 3);
    solver = std::make_unique<FluidSolver>(o, points, std::vector<Vec3>(points.size(), Vec3::Zero()),
                                           solid_walls(test::container(kWidth, 0.8, 0.2)),
                                           std::span<const std::uint8_t>(), std::span<const int>(),
                                           std::span<const double>(), body);
  }
  /// How deep it is in the liquid, by the liquid's volume [m].
  double draught() const {
    const double bottom = solver->bodies().front().velocity.point.y() - kHeight / 2;
    return (volume - kWidth * kWidth * bottom) / (kWidth * kWidth - kSide * kSide);
  }

  FluidOptions o;
  std::vector<RigidBody> body;
  std::unique_ptr<FluidSolver> solver;
  double volume = 0;
};

// Archimedes' level, and back to it after a push; upright, as a flat box is.
TEST(RigidBodies, ABoxFloatsAtArchimedesLevelAndReturnsToIt) {
  for (const double speed : {0.0, -0.5}) {
    Afloat all(500, speed);
    double deepest = 0, mean = 0;
    int count = 0;
    while (all.solver->time() < 3) {
      all.solver->step(3 - all.solver->time());
      deepest = std::max(deepest, all.draught());
      if (all.solver->time() < 1.5) continue;
      mean += all.draught();
      ++count;
    }
    EXPECT_NEAR(mean / count, 0.5 * Afloat::kHeight, 0.25 * kSpacing) << speed;
    if (speed < 0) {
      EXPECT_GT(deepest, 0.6 * Afloat::kHeight);
    }
    EXPECT_LT(std::acos(all.solver->bodies().front().pose.rotation(1, 1)), 0.05) << speed;
  }
}

TEST(RigidBodies, DoNotMakeEnergy) {
  Afloat all(500, -0.5);
  double least = momenta(*all.solver, all.body.front(), all.o).energy;
  const double kinetic = all.body.front().mass * 0.25 / 2;
  while (all.solver->time() < 1) {
    all.solver->step(1);
    const double now = momenta(*all.solver, all.body.front(), all.o).energy;
    ASSERT_LT(now, least + 0.02 * kinetic) << all.solver->time();
    least = std::min(least, now);
  }
}

}  // namespace
}  // namespace kappaflow
