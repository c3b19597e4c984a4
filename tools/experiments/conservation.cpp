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

// Limits of the basin, in units of sqrt(g h). The lattice settles by a share of the spacing at first; after
// that a particle that moved 1 percent of sqrt(g h) would cross a spacing in two seconds.
constexpr double kFastestAtRest = 0.05;
constexpr double kMeanAtRest = 0.01;
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
  FluidParticlesAtStart start = fill_blocks(scene);
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

/// whole: the duration of what is not the quick variant [s].
Report chapter(const ExperimentContext& context, const Scene& scene, double whole, std::string introduction) {
  Report report;
  add_smaller(report, "duration", fmt::format("{:.3g} s", scene.duration), fmt::format("{:.3g} s", whole));
  report.name = context.name;
  report.title = scene.title;
  report.introduction = std::move(introduction);
  report.files = {"history.csv", context.name + ".gp"};
  return report;
}

}  // namespace

Report validate_drop(const ExperimentContext& context) {
  Scene scene = load_scene(context.file);
  const double whole = scene.duration;
  if (context.options.quick) scene.duration /= 5;
  context.say("spinning");
  const double radius = std::get<SphereShape>(scene.blocks.front().shape).radius;
  FluidSolver liquid = spinning_drop(scene);
  const Particles before = liquid.particles();
  const Momenta start = momenta(before);
  const double scale = mean_speed(before);
  std::vector<std::vector<double>> rows;
  Curve linear{"linear", {}}, angular{"angular", {}};
  double linear_error = 0, angular_error = 0, reach = 0;
  advance(liquid, scene.duration, [&](const FluidStep&) {
    const Particles p = liquid.particles();
    const Momenta now = momenta(p);
    const double d = (now.linear - start.linear).norm() / scale,
                 a = (now.angular - start.angular).norm() / start.angular.norm();
    linear_error = std::max(linear_error, d);
    angular_error = std::max(angular_error, a);
    reach = furthest(p, now.center) / radius;
    linear.points.emplace_back(p.time, d);
    angular.points.emplace_back(p.time, a);
    rows.push_back({p.time, d, a, reach, kinetic_energy(p)});
  });
  draw_plots(context.folder, context.name,
             std::vector{Plot{
                 "Change of a drop's momentum", "t [s]", "relative to the start", {linear, angular}, true}});
  write_file(context.folder / "history.csv",
             csv_text("time,linear_error,angular_error,reach,kinetic_energy", rows));
  Report report = chapter(
      context, scene, whole,
      fmt::format("`{}`: {} particles, {} steps; the drop spins with rho omega^2 R^3 / (8 sigma) = {}.",
                  context.file.filename().string(), liquid.size(), rows.size(), kRotationalBond));
  report.statements = {
      within_limits("Newton", "A free drop keeps its linear momentum.", {{"", linear_error, kMomentumLimit}},
                    "Largest change over the mean speed of its particles."),
      within_limits("Newton", "A free drop keeps its angular momentum.", {{"", angular_error, kAngularLimit}},
                    "Largest relative change, about its centre of mass."),
      within_limits("kappaflow", "Surface tension holds the spinning drop together.",
                    {{"", reach, kRadiusLimit}}, "Furthest particle over the radius, at the end.")};
  report.figures = {{context.name + ".png", "What rounding takes from the momentum."}};
  return report;
}

Report validate_basin(const ExperimentContext& context) {
  Scene scene = load_scene(context.file);
  const double whole = scene.duration;
  if (context.options.quick) scene.duration /= 3;
  context.say("resting");
  FluidSolver liquid = make_liquid(scene);
  const double depth = std::get<BoxShape>(scene.blocks.back().shape).upper.y(),
               potential = scene.fluid.gravity.norm() * depth, speed_unit = std::sqrt(potential);
  std::vector<std::vector<double>> rows;
  Curve fastest{"fastest", {}}, mean{"mean", {}};
  double fastest_at_rest = 0, mean_at_rest = 0;
  Vec2 energy = Vec2::Zero();  // times seconds, of the second and of the last third
  advance(liquid, scene.duration, [&](const FluidStep& step) {
    const Particles p = liquid.particles();
    const double top = step.fastest / speed_unit, average = mean_speed(p) / speed_unit,
                 kinetic = kinetic_energy(p) / potential;
    fastest.points.emplace_back(p.time, top);
    mean.points.emplace_back(p.time, average);
    rows.push_back({p.time, top, average, kinetic});
    const double third = 3 * p.time / scene.duration;
    if (third <= 1) return;
    energy[third > 2] += kinetic * step.time_step;
    fastest_at_rest = std::max(fastest_at_rest, top);
    mean_at_rest = std::max(mean_at_rest, average);
  });
  draw_plots(
      context.folder, context.name,
      std::vector{Plot{"Speeds of a liquid at rest", "t [s]", "speed / sqrt(g h)", {fastest, mean}, true}});
  write_file(context.folder / "history.csv", csv_text("time,fastest,mean,kinetic_energy", rows));
  Report report = chapter(context, scene, whole,
                          fmt::format("`{}`: {} particles for {:.3g} s; the first third is left out.",
                                      context.file.filename().string(), liquid.size(), scene.duration));
  const double noise = kLeastEnergy * scene.duration / 3;
  report.statements = {
      within_limits("hydrostatics", "A liquid at rest stays at rest.",
                    {{"fastest", fastest_at_rest, kFastestAtRest}, {"mean", mean_at_rest, kMeanAtRest}},
                    "Speeds over sqrt(g h), the largest of all times."),
      within_limits("hydrostatics", "Walls do not stir it.",
                    {{"", energy[1] / std::max(energy[0], noise), kEnergyGrowth}},
                    "Mean kinetic energy of the last third over that of the second, or over what is noise.")};
  report.figures = {{context.name + ".png", "The fastest particle and the mean."}};
  return report;
}

Report validate_falling(const ExperimentContext& context) {
  Scene scene = load_scene(context.file);
  const double whole = scene.duration;
  if (context.options.quick) scene.duration /= 2;
  context.say("falling");
  FluidSolver liquid = make_liquid(scene);
  const double g = scene.fluid.gravity.norm(), start = scene.blocks.front().velocity.norm();
  double highest = -1e300, largest = 0, compression = 0;
  for (const Vec3& x : liquid.particles().position) highest = std::max(highest, x.y());
  std::vector<std::vector<double>> rows;
  Curve fastest{"fastest particle", {}}, free_fall{"free fall", {}};
  advance(liquid, scene.duration, [&](const FluidStep& step) {
    const Particles p = liquid.particles();
    double lowest = highest;
    for (const Vec3& x : p.position) lowest = std::min(lowest, x.y());
    const double free = std::sqrt(start * start + 2 * g * (highest - lowest));
    largest = std::max(largest, step.fastest / free);
    compression = std::max(compression, step.density_error_max);
    fastest.points.emplace_back(p.time, step.fastest);
    free_fall.points.emplace_back(p.time, free);
    rows.push_back({p.time, step.fastest, free, step.density_error_max, step.time_step,
                    static_cast<double>(step.density_iterations)});
  });
  draw_plots(context.folder, context.name,
             std::vector{Plot{"Thin liquid falls off stairs", "t [s]", "speed [m/s]", {fastest, free_fall}}});
  write_file(context.folder / "history.csv",
             csv_text("time,fastest,free_fall,compression_max,time_step,density_iterations", rows));
  Report report = chapter(context, scene, whole,
                          fmt::format("`{}`: {} particles; largest compression of a particle {:.3g} %.",
                                      context.file.filename().string(), liquid.size(), 100 * compression));
  report.statements = {within_limits("energy", "No particle becomes faster than free fall makes it.",
                                     {{"", largest, kFasterThanFree}},
                                     "Fastest particle over sqrt(v0^2 + 2 g drop), drop from the highest "
                                     "particle at the start to the lowest "
                                     "one now; the largest of all times.")};
  report.figures = {{context.name + ".png", "The fastest particle, and a free fall from the highest one."}};
  return report;
}

}  // namespace kappaflow
