#include "tools/experiments/conservation.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tools/experiments/validation.h"
#include "tools/io/files.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

// Limits of the drop. Pair forces cancel to the rounding of single precision, 6e-8 a step; over a thousand
// steps that adds up to some 1e-6 at random, and 6e-5 if it were all to one side. All forces have an energy
// that rigid motions leave alone, so the angular momentum is lost to rounding only; 1 percent leaves room for
// the rounding of the lists' gradients.
constexpr double kMomentumLimit = 1e-5;
constexpr double kAngularLimit = 0.01;
constexpr double kRadiusLimit = 1.2;  // of the furthest particle, over the drop's radius: it stays one drop
// rho omega^2 R^3 / (8 sigma): a spinning drop of 0.1 is oblate by 4 percent and stable (Chandrasekhar, "The
// stability of a rotating liquid drop", 1965).
constexpr double kRotationalBond = 0.1;

// Limits of the basin, in units of sqrt(g h), after the first third: under pressure the lattice of the start
// is no stable packing, and particles sink into another one for some seconds.
constexpr double kFastestAtRest = 0.02;
constexpr double kMeanAtRest = 0.002;
constexpr double kEnergyGrowth = 1.0;  // of the last third over that of the second
constexpr double kLeastEnergy = 1e-5;  // below it, in units of g h, growth is noise

// Limit of the falling liquid. The sum of the energies cannot grow, but one particle may take over some of
// its neighbours' in an impact; on the way down those are all within a spacing or two, and free fall over
// that distance is what they have over it: a tenth of the speed.
constexpr double kFasterThanFree = 1.1;

double mean_speed(const Particles& p) {
  double sum = 0;
  for (const Vec3& v : p.velocity) sum += v.norm();
  return sum / static_cast<double>(p.size());
}

/// Mean kinetic energy per mass [m2/s2].
double kinetic_energy(const Particles& p) {
  double sum = 0;
  for (const Vec3& v : p.velocity) sum += 0.5 * v.squaredNorm();
  return sum / static_cast<double>(p.size());
}

struct Momenta {
  Vec3 center = Vec3::Zero(), linear = Vec3::Zero(),
       angular = Vec3::Zero();  // per particle; about the center
};

Momenta momenta(const Particles& p) {
  Momenta m;
  const double n = static_cast<double>(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    m.center += p.position[i] / n;
    m.linear += p.velocity[i] / n;
  }
  for (std::size_t i = 0; i < p.size(); ++i)
    m.angular += (p.position[i] - m.center).cross(p.velocity[i] - m.linear) / n;
  return m;
}

/// The drop of the scene, spinning about z.
FluidSolver spinning_drop(const Scene& scene) {
  const auto& drop = std::get<SphereShape>(scene.blocks.front().shape);
  FluidParticlesAtStart start = prepare(scene).start;
  const double rate = std::sqrt(8 * kRotationalBond * scene.fluid.surface_tension /
                                (scene.fluid.density * std::pow(drop.radius, 3)));
  for (std::size_t i = 0; i < start.position.size(); ++i)
    start.velocity[i] += rate * Vec3::UnitZ().cross(start.position[i] - drop.center);
  return {scene.fluid, start.position, start.velocity, {}};
}

double furthest(const Particles& p, const Vec3& center) {
  double distance = 0;
  for (const Vec3& x : p.position) distance = std::max(distance, (x - center).norm());
  return distance;
}

// What is claimed.

const Claim kDropKeepsLinear{"Newton", "A free drop keeps its linear momentum.",
                             "Largest change over the mean speed of its particles."};
const Claim kDropKeepsAngular{"Newton", "A free drop keeps its angular momentum.",
                              "Largest relative change, about its centre of mass."};
const Claim kDropStaysWhole{"kappaflow", "Surface tension holds the spinning drop together.",
                            "Furthest particle over the radius, at the end."};
const Claim kBasinStaysAtRest{"hydrostatics", "A liquid at rest stays at rest.",
                              "Speeds over sqrt(g h), the largest of all times."};
const Claim kBasinIsNotStirred{
    "hydrostatics", "Walls do not stir it.",
    "Mean kinetic energy of the last third over that of the second, or over what is noise."};
const Claim kNotFasterThanFree{"energy", "No particle becomes faster than free fall makes it.",
                               "Fastest particle over sqrt(v0^2 + 2 g drop), drop from the highest "
                               "particle at the start to the lowest "
                               "one now; the largest of all times."};

/// A row of numbers a time step, the time first.
using History = std::vector<std::vector<double>>;

Curve curve_of(const History& history, const std::string& name, std::size_t column) {
  Curve curve{name, {}};
  for (const std::vector<double>& row : history) curve.points.emplace_back(row[0], row[column]);
  return curve;
}

/// The scene of a validation, and how long it is simulated.
struct ScenePart {
  Scene scene;
  double whole;  ///< the duration of what is not the quick variant [s]
};

/// shorter: how many times the quick variant is.
ScenePart scene_part(const ExperimentContext& context, double shorter) {
  ScenePart part{load_scene(context.file), 0};
  part.whole = part.scene.duration;
  if (context.options.quick) part.scene.duration /= shorter;
  return part;
}

Report chapter(const ExperimentContext& context, const ScenePart& part, std::string introduction) {
  Report report;
  add_smaller(report, "duration", fmt::format("{:.3g} s", part.scene.duration),
              fmt::format("{:.3g} s", part.whole));
  report.name = context.name;
  report.title = part.scene.title;
  report.introduction = std::move(introduction);
  report.files = {"history.csv"};
  return report;
}

void add_history(Report& report, const ExperimentContext& context, const History& history,
                 const std::string& header, const Plot& plot, const std::string& caption) {
  write_file(context.folder / "history.csv", csv_text(header, history));
  add_plots(report, context, context.name, std::vector{plot}, caption);
}

struct DropResult {
  std::size_t particles = 0;
  History history;  ///< time, change of momentum, of angular momentum, reach, kinetic energy
  double linear_error = 0, angular_error = 0;  ///< the largest
  double reach = 0;                            ///< of the furthest particle at the end, over the radius
};

DropResult run_drop(const Scene& scene) {
  const double radius = std::get<SphereShape>(scene.blocks.front().shape).radius;
  FluidSolver liquid = spinning_drop(scene);
  const Particles before = liquid.particles();
  const Momenta start = momenta(before);
  const double scale = mean_speed(before);
  DropResult r;
  r.particles = liquid.size();
  advance(liquid, scene.duration, [&](const FluidStep&) {
    const Particles p = liquid.particles();
    const Momenta now = momenta(p);
    const double d = (now.linear - start.linear).norm() / scale,
                 a = (now.angular - start.angular).norm() / start.angular.norm();
    r.linear_error = std::max(r.linear_error, d);
    r.angular_error = std::max(r.angular_error, a);
    r.reach = furthest(p, now.center) / radius;
    r.history.push_back({p.time, d, a, r.reach, kinetic_energy(p)});
  });
  return r;
}

struct BasinResult {
  std::size_t particles = 0;
  History history;  ///< time, fastest and mean speed, kinetic energy; in units of sqrt(g h) and g h
  double fastest = 0, mean = 0;  ///< the largest after the first third
  Vec2 energy = Vec2::Zero();    ///< times seconds, of the second and of the last third
};

BasinResult run_basin(const Scene& scene) {
  FluidSolver liquid = make_liquid(scene);
  const double depth = std::get<BoxShape>(scene.blocks.back().shape).upper.y(),
               potential = scene.fluid.gravity.norm() * depth, speed_unit = std::sqrt(potential);
  BasinResult r;
  r.particles = liquid.size();
  advance(liquid, scene.duration, [&](const FluidStep& step) {
    const Particles p = liquid.particles();
    const double top = step.fastest / speed_unit, average = mean_speed(p) / speed_unit,
                 kinetic = kinetic_energy(p) / potential;
    r.history.push_back({p.time, top, average, kinetic});
    const double third = 3 * p.time / scene.duration;
    if (third <= 1) return;
    r.energy[third > 2] += kinetic * step.time_step;
    r.fastest = std::max(r.fastest, top);
    r.mean = std::max(r.mean, average);
  });
  return r;
}

struct FallingResult {
  std::size_t particles = 0;
  History history;  ///< time, fastest speed, that of free fall [m/s], compression, time step [s], iterations
  double fastest = 0;      ///< over free fall
  double compression = 0;  ///< of a particle, the largest
};

FallingResult run_falling(const Scene& scene) {
  FluidSolver liquid = make_liquid(scene);
  const double g = scene.fluid.gravity.norm(), start = scene.blocks.front().velocity.norm();
  double highest = -1e300;
  for (const Vec3& x : liquid.particles().position) highest = std::max(highest, x.y());
  FallingResult r;
  r.particles = liquid.size();
  advance(liquid, scene.duration, [&](const FluidStep& step) {
    const Particles p = liquid.particles();
    double lowest = highest;
    for (const Vec3& x : p.position) lowest = std::min(lowest, x.y());
    const double free = std::sqrt(start * start + 2 * g * (highest - lowest));
    r.fastest = std::max(r.fastest, step.fastest / free);
    r.compression = std::max(r.compression, step.density_error_max);
    r.history.push_back({p.time, step.fastest, free, step.density_error_max, step.time_step,
                         static_cast<double>(step.density_iterations)});
  });
  return r;
}

}  // namespace

Report validate_drop(const ExperimentContext& context) {
  const ScenePart part = scene_part(context, 5);
  context.say("spinning");
  const DropResult r = run_drop(part.scene);
  Report report = chapter(
      context, part,
      fmt::format("`{}`: {} particles, {} steps; the drop spins with rho omega^2 R^3 / (8 sigma) = {}.",
                  context.file.filename().string(), r.particles, r.history.size(), kRotationalBond));
  report.statements = {judged(kDropKeepsLinear, {at_most("", r.linear_error, kMomentumLimit)}),
                       judged(kDropKeepsAngular, {at_most("", r.angular_error, kAngularLimit)}),
                       judged(kDropStaysWhole, {at_most("", r.reach, kRadiusLimit)})};
  add_history(report, context, r.history, "time,linear_error,angular_error,reach,kinetic_energy",
              {"Change of a drop's momentum",
               "t [s]",
               "relative to the start",
               {curve_of(r.history, "linear", 1), curve_of(r.history, "angular", 2)},
               true},
              "What rounding takes from the momentum.");
  return report;
}

Report validate_basin(const ExperimentContext& context) {
  const ScenePart part = scene_part(context, 3);
  context.say("resting");
  const BasinResult r = run_basin(part.scene);
  Report report = chapter(context, part,
                          fmt::format("`{}`: {} particles for {:.3g} s; the first third is left out.",
                                      context.file.filename().string(), r.particles, part.scene.duration));
  const double noise = kLeastEnergy * part.scene.duration / 3;
  report.statements = {
      judged(kBasinStaysAtRest,
             {at_most("fastest", r.fastest, kFastestAtRest), at_most("mean", r.mean, kMeanAtRest)}),
      judged(kBasinIsNotStirred, {at_most("", r.energy[1] / std::max(r.energy[0], noise), kEnergyGrowth)})};
  add_history(report, context, r.history, "time,fastest,mean,kinetic_energy",
              {"Speeds of a liquid at rest",
               "t [s]",
               "speed / sqrt(g h)",
               {curve_of(r.history, "fastest", 1), curve_of(r.history, "mean", 2)},
               true},
              "The fastest particle and the mean.");
  return report;
}

Report validate_falling(const ExperimentContext& context) {
  const ScenePart part = scene_part(context, 2);
  context.say("falling");
  const FallingResult r = run_falling(part.scene);
  Curve free_fall = curve_of(r.history, "free fall", 2);
  free_fall.look = Look::reference;
  Report report = chapter(context, part,
                          fmt::format("`{}`: {} particles; largest compression of a particle {:.3g} %.",
                                      context.file.filename().string(), r.particles, 100 * r.compression));
  report.statements = {judged(kNotFasterThanFree, {at_most("", r.fastest, kFasterThanFree)})};
  add_history(report, context, r.history,
              "time,fastest,free_fall,compression_max,time_step,density_iterations",
              {"Thin liquid falls off stairs",
               "t [s]",
               "speed [m/s]",
               {curve_of(r.history, "fastest particle", 1), free_fall}},
              "The fastest particle, and a free fall from the highest one.");
  return report;
}

}  // namespace kappaflow
