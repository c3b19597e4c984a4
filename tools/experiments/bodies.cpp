#include "tools/experiments/bodies.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "solver/wall_bodies.h"
#include "tools/experiments/sphere_in_jar.h"
#include "tools/experiments/validation.h"
#include "tools/io/files.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

// Walls are irregular, and liquid fills what room they leave.
constexpr double kDraughtLimit = 0.25;  // [spacings]
constexpr double kSwingLimit = 0.1;     // what is left of the first swing in the last quarter [1]
constexpr double kTiltLimit = 0.05;     // [rad]
// Of the mean speed, relative to the known one, over (spacing / radius)^2: it converges so, from above.
constexpr double kSpeedLimit = 5;
constexpr double kDriftLimit = 0.1;  // of the path, across the axis over that along it
// Single precision rounds by 6e-8; some hundred steps all to one side would add up to 1e-5.
constexpr double kJointMomentumLimit = 1e-5;  // relative to the sum of all momenta's lengths
constexpr double kEnergyLimit = 0.01;         // what it rises by, relative to the kinetic energy at first

const Claim kFloatsAtArchimedesLevel{
    "Archimedes", "A body sinks in until it displaces its weight.",
    "Mean draught over the second half of the time, by the liquid's volume, off the known one, in spacings."};
const Claim kReturns{
    "statics", "Pushed down, it comes back, upright.",
    "Largest swing about the mean in the last quarter, over the largest; angle to the vertical [rad]."};
const Claim kSinksAtStokesSpeed{
    "Stokes; Haberman & Sayre 1958", "A sphere in a jar sinks at the known speed.",
    "Mean speed over the second half of its path, relative to the known one; path across the axis."};
const Claim kKeepsMomentum{"Newton's third law", "Body and liquid keep their momentum together.",
                           "Largest change over the sum of all lengths, after the last step."};
const Claim kMakesNoEnergy{"first law", "Energy never rises.",
                           "Largest rise above what it was before, over the kinetic energy at first."};

double edge(const BoxShape& box, int axis) {
  return box.upper[axis] - box.lower[axis];
}

/// Sums over the liquid and the body.
struct JointMomenta {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  double lengths = 0, arms = 0;  // of the momenta, and of their moments
  double kinetic = 0, energy = 0;

  JointMomenta(const FluidSolver& liquid, const FluidOptions& fluid, const RigidBody& body) {
    const Particles p = liquid.particles();
    const double mass = fluid.density * std::pow(fluid.spacing, 3);
    for (std::size_t i = 0; i < p.size(); ++i) add(mass, p.position[i], p.velocity[i], fluid.gravity);
    const BodyState state = liquid.bodies().front();
    add(body.mass, state.velocity.point, state.velocity.linear, fluid.gravity);
    const Mat3& rotation = state.pose.rotation;
    const Vec3 spin = body.mass * rotation * mass_properties(body.solid.surface()).inertia *
                      rotation.transpose() * state.velocity.angular;
    angular += spin;
    arms += spin.norm();
    kinetic += spin.dot(state.velocity.angular) / 2;
    energy += spin.dot(state.velocity.angular) / 2;
  }

 private:
  void add(double mass, const Vec3& x, const Vec3& v, const Vec3& gravity) {
    linear += mass * v;
    angular += mass * x.cross(v);
    lengths += mass * v.norm();
    arms += mass * x.norm() * v.norm();
    kinetic += mass * v.squaredNorm() / 2;
    energy += mass * (v.squaredNorm() / 2 - gravity.dot(x));
  }
};

/// The largest rise of the energy above its least value before.
class EnergyWatch {
 public:
  explicit EnergyWatch(const JointMomenta& first) : kinetic_(first.kinetic), least_(first.energy) {}
  void add(double energy) {
    rise_ = std::max(rise_, energy - least_);
    least_ = std::min(least_, energy);
  }
  double relative_rise() const { return rise_ / kinetic_; }

 private:
  double kinetic_, least_, rise_ = 0;
};

struct FloatResult {
  double spacing;
  std::size_t particles;
  std::vector<Vec2> draught;  ///< (time [s], draught over the box's height)
  double error = 0, swing = 0, tilt = 0, rise = 0;
};

FloatResult run_float(const Scene& scene) {
  const PreparedScene prepared = prepare(scene);
  const auto& box = std::get<BoxShape>(scene.bodies.front().shape);
  const auto& basin = std::get<BasinShape>(scene.walls.front().shape);
  const double height = edge(box, 1), section = edge(box, 0) * edge(box, 2),
               area = (basin.upper.x() - basin.lower.x()) * (basin.upper.z() - basin.lower.z());
  FluidSolver liquid = make_liquid(prepared);
  const double volume = static_cast<double>(liquid.size()) * std::pow(scene.fluid.spacing, 3),
               known = *scene.bodies.front().density / scene.fluid.density * height;
  FloatResult r{scene.fluid.spacing, liquid.size(), {}};
  EnergyWatch energy(JointMomenta(liquid, scene.fluid, prepared.bodies.front()));
  double mean = 0;
  int count = 0;
  advance(liquid, scene.duration, [&](const FluidStep&) {
    const double bottom = liquid.bodies().front().velocity.point.y() - height / 2 - basin.lower.y();
    const double draught = (volume - area * bottom) / (area - section);
    r.draught.emplace_back(liquid.time(), draught / height);
    energy.add(JointMomenta(liquid, scene.fluid, prepared.bodies.front()).energy);
    if (liquid.time() < 0.5 * scene.duration) return;
    mean += draught;
    ++count;
  });
  mean /= count;
  r.error = std::abs(mean - known) / scene.fluid.spacing;
  double largest = 0;
  for (const Vec2& at : r.draught) {
    const double swing = std::abs(at.y() - mean / height);
    largest = std::max(largest, swing);
    if (at.x() > 0.75 * scene.duration) r.swing = std::max(r.swing, swing);
  }
  r.swing /= largest;
  r.tilt = std::acos(std::min(1.0, liquid.bodies().front().pose.rotation(1, 1)));
  r.rise = energy.relative_rise();
  return r;
}

constexpr double kHeld = 0.4;  // until liquid has filled what the lattice leaves free at the jar [s]

struct SinkResult {
  double spacing;
  std::size_t particles;
  std::vector<Vec2> speed;  ///< (path over radius, speed over the known one)
  double error = 0, drift = 0;
};

/// The sphere is a wall for a while, then a body.
SinkResult run_sinking(const Scene& scene, double known) {
  PreparedScene prepared = prepare(scene);
  const double radius = std::get<SphereShape>(scene.bodies.front().shape).radius;
  {
    FluidSolver held(scene.fluid, prepared.start.position, prepared.start.velocity,
                     all_solids(prepared.walls, prepared.bodies));
    advance(held, kHeld);
    prepared.start.position = held.particles().position;
    prepared.start.velocity.assign(held.size(), Vec3::Zero());
  }
  FluidSolver liquid = make_liquid(prepared);
  SinkResult r{scene.fluid.spacing, liquid.size(), {}};
  const Vec3 first = liquid.bodies().front().velocity.point;
  std::vector<Vec2> path;  // (time, path)
  constexpr int kTimes = 40;
  for (int k = 1; k <= kTimes; ++k) {
    advance(liquid, (scene.duration - kHeld) * k / kTimes);
    const BodyState state = liquid.bodies().front();
    const Vec3 way = state.velocity.point - first;
    path.emplace_back(liquid.time(), -way.y());
    // It falls at once until the liquid under it bears.
    if (k > kTimes / 4) r.speed.emplace_back(-way.y() / radius, -state.velocity.linear.y() / known);
    r.drift = std::max(r.drift, std::hypot(way.x(), way.z()));
  }
  const Vec2 half = path[path.size() / 2 - 1], whole = path.back();
  r.error = (whole.y() - half.y()) / (whole.x() - half.x()) / known - 1;
  r.drift /= whole.y();
  return r;
}

}  // namespace

Report validate_floating_box(const ExperimentContext& context) {
  const Scene scene = load_scene(context.file);
  const std::vector<double> whole{1, 0.5}, factors = context.options.quick ? std::vector{1.0} : whole;
  Plot plot{"A box that is pushed down", "time [s]", "draught / height", {}};
  std::vector<std::vector<double>> rows, times;
  std::vector<Check> level, back, energy;
  for (const double factor : factors) {
    const Scene refined = with_spacing(scene, factor * scene.fluid.spacing);
    const std::string at = at_spacing(refined.fluid.spacing);
    context.say(at);
    const FloatResult r = run_float(refined);
    plot.curves.push_back({at, r.draught, Look::line});
    rows.push_back({r.spacing, static_cast<double>(r.particles), r.error, r.swing, r.tilt, r.rise});
    level.push_back(at_most(at, r.error, kDraughtLimit));
    back.push_back(at_most("swing, " + at, r.swing, kSwingLimit));
    back.push_back(at_most("tilt, " + at, r.tilt, kTiltLimit));
    energy.push_back(at_most(at, r.rise, kEnergyLimit));
    for (const Vec2& p : r.draught) times.push_back({r.spacing, p.x(), p.y()});
  }
  const double known = *scene.bodies.front().density / scene.fluid.density;
  plot.curves.push_back({"Archimedes", {{0, known}, {scene.duration, known}}, Look::reference});
  write_file(context.folder / "draught.csv", csv_text("spacing,time,draught", times));
  write_file(context.folder / "summary.csv", csv_text("spacing,particles,error,swing,tilt,rise", rows));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format(
      "`{}`: a flat box, {:.3g} times as dense as the liquid, begins at Archimedes' level with a push of "
      "{:.3g} m/s down.",
      context.file.filename().string(), known, scene.bodies.front().velocity.norm());
  add_smaller(report, "spacing", spacings_text(scene, factors), spacings_text(scene, whole));
  report.statements = {judged(kFloatsAtArchimedesLevel, level), judged(kReturns, back),
                       judged(kMakesNoEnergy, energy)};
  add_plots(report, context, context.name, std::vector{plot}, "Draught of the box.");
  report.files = {"summary.csv", "draught.csv"};
  return report;
}

Report validate_sinking_sphere(const ExperimentContext& context) {
  const Scene scene = load_scene(context.file);
  const auto& sphere = std::get<SphereShape>(scene.bodies.front().shape);
  const auto& block = std::get<BoxShape>(scene.blocks.front().shape);
  const SphereInJar jar{.radius = sphere.radius,
                        .jar_radius = edge(block, 0) / 2,
                        .excess_density = *scene.bodies.front().density - scene.fluid.density,
                        .gravity = scene.fluid.gravity.norm(),
                        .viscosity = scene.fluid.density * scene.fluid.kinematic_viscosity,
                        .inner_viscosity = kInfinity};
  const double known = jar.speed();
  const std::vector<double> whole{1, 0.8, 0.5}, factors = context.options.quick ? std::vector{1.0} : whole;
  Plot plot{"A sphere sinks in a jar", "path / radius", "speed / known speed", {}};
  std::vector<std::vector<double>> rows, speeds;
  std::vector<Check> checks;
  double farthest = 0;
  for (const double factor : factors) {
    const Scene refined = with_spacing(scene, factor * scene.fluid.spacing);
    const std::string at = at_spacing(refined.fluid.spacing);
    context.say(at);
    const SinkResult r = run_sinking(refined, known);
    plot.curves.push_back({at, r.speed, Look::points});
    rows.push_back({r.spacing, static_cast<double>(r.particles), r.error, r.drift});
    const double coarse = r.spacing / sphere.radius;
    checks.push_back(at_most("speed, " + at, std::abs(r.error), kSpeedLimit * coarse * coarse));
    checks.push_back(at_most("drift, " + at, r.drift, kDriftLimit));
    for (const Vec2& p : r.speed) speeds.push_back({r.spacing, p.x(), p.y()});
    farthest = std::max(farthest, r.speed.back().x());
  }
  plot.curves.push_back({"Haberman & Sayre", {{0, 1}, {farthest, 1}}, Look::reference});
  write_file(context.folder / "speeds.csv", csv_text("spacing,path,speed", speeds));
  write_file(context.folder / "summary.csv", csv_text("spacing,particles,error,drift", rows));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format(
      "`{}`: a sphere of {:.3g} times the density of the liquid in a jar {:.3g} times as wide. Stokes' speed "
      "is {:.4g} m/s, that in the jar {:.4g} m/s.",
      context.file.filename().string(), 1 + jar.excess_density / scene.fluid.density,
      jar.jar_radius / jar.radius, jar.unbounded_speed(), known);
  add_smaller(report, "spacing", spacings_text(scene, factors), spacings_text(scene, whole));
  report.statements = {judged(kSinksAtStokesSpeed, checks)};
  add_plots(report, context, context.name, std::vector{plot}, "Speed of the sphere on its way.");
  report.files = {"summary.csv", "speeds.csv"};
  return report;
}

Report validate_spinning_body(const ExperimentContext& context) {
  const Scene scene = load_scene(context.file);
  const PreparedScene prepared = prepare(scene);
  FluidSolver liquid = make_liquid(prepared);
  const RigidBody& body = prepared.bodies.front();
  const JointMomenta first(liquid, scene.fluid, body);
  EnergyWatch energy(first);
  const double duration = context.options.quick ? scene.duration / 3 : scene.duration;
  std::vector<std::vector<double>> rows;
  double linear = 0, angular = 0;
  advance(liquid, duration, [&](const FluidStep&) {
    const JointMomenta now(liquid, scene.fluid, body);
    linear = (now.linear - first.linear).norm() / first.lengths;
    angular = (now.angular - first.angular).norm() / first.arms;
    energy.add(now.energy);
    rows.push_back({liquid.time(), linear, angular, now.energy / first.energy});
  });
  write_file(context.folder / "momenta.csv", csv_text("time,linear,angular,energy", rows));
  write_file(context.folder / "summary.csv",
             csv_text("linear,angular,rise", {{linear, angular, energy.relative_rise()}}));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format("`{}`: {:.3g} s of a body that moves and turns in a drop without weight.",
                                    context.file.filename().string(), duration);
  add_smaller(report, "duration", fmt::format("{:.3g} s", duration), fmt::format("{:.3g} s", scene.duration));
  report.statements = {judged(kKeepsMomentum, {at_most("linear", linear, kJointMomentumLimit),
                                               at_most("angular", angular, kJointMomentumLimit)}),
                       judged(kMakesNoEnergy, {at_most("rise", energy.relative_rise(), kEnergyLimit)})};
  std::vector<Vec2> of_linear, of_angular;
  for (const auto& row : rows) {
    of_linear.emplace_back(row[0], row[1]);
    of_angular.emplace_back(row[0], row[2]);
  }
  const Plot plot{"Momentum of body and drop",
                  "time [s]",
                  "change / sum of lengths",
                  {{"linear", of_linear, Look::line}, {"angular", of_angular, Look::line}}};
  add_plots(report, context, context.name, std::vector{plot}, "Change of the momenta since the start.");
  report.files = {"summary.csv", "momenta.csv"};
  return report;
}

}  // namespace kappaflow
