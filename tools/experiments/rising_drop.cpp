#include "tools/experiments/rising_drop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/experiments/sphere_in_jar.h"
#include "tools/experiments/validation.h"
#include "tools/io/files.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

constexpr double kRiseLimit = 0.15;  // of the mean speed, relative to the known one
constexpr double kSettled = 0.4;     // liquid has then filled what the lattice leaves free at the jar [s]
constexpr int kTimes = 20;           // at which the drop is looked at

const Claim kRises{"Hadamard 1911; Haberman & Sayre 1958", "A drop in a jar rises at the known speed.",
                   "Mean speed over the second half of the time, relative to the known one."};

/// Liquid at rest in the jar, of which a ball is the drop.
FluidSolver make_drop(const Scene& scene, const SphereShape& drop) {
  const PreparedScene prepared = prepare(scene);
  FluidOptions one = scene.fluid;
  one.more_viscosities.clear();
  one.more_densities.clear();
  one.rheologies.clear();
  one.temperature_laws.clear();
  FluidSolver settling(one, prepared.start.position, prepared.start.velocity, prepared.walls);
  advance(settling, kSettled);
  const std::vector<Vec3> position = settling.particles().position;
  std::vector<std::uint8_t> fluid;
  fluid.reserve(position.size());
  for (const Vec3& x : position)
    fluid.push_back((x - drop.center).norm() < drop.radius ? scene.blocks[0].fluid : 0);
  return {scene.fluid, position, std::vector<Vec3>(position.size(), Vec3::Zero()), prepared.walls, fluid};
}

double height_of_drop(const FluidSolver& liquid) {
  const Particles particles = liquid.particles();
  const std::vector<std::uint8_t> fluids = liquid.fluids();
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (fluids[i] == 0) continue;
    sum += particles.position[i].y();
    ++count;
  }
  return sum / count;
}

struct RiseResult {
  double spacing;
  std::size_t particles;
  std::vector<Vec2> speed;  ///< (path over radius, speed over the known one)
  double error = 0;
};

RiseResult run_rising(const Scene& scene, const SphereShape& drop, double known) {
  FluidSolver liquid = make_drop(scene, drop);
  RiseResult r{scene.fluid.spacing, liquid.size(), {}};
  const double first = height_of_drop(liquid);
  std::vector<Vec2> path{{0, 0}};  // (time, path)
  for (int k = 1; k <= kTimes; ++k) {
    advance(liquid, scene.duration * k / kTimes);
    path.emplace_back(liquid.time(), height_of_drop(liquid) - first);
    const Vec2 step = path.back() - path[path.size() - 2];
    if (k > kTimes / 10)
      r.speed.emplace_back((path.back().y() - step.y() / 2) / drop.radius, step.y() / step.x() / known);
  }
  const Vec2 way = path.back() - path[kTimes / 2];
  r.error = way.y() / way.x() / known - 1;
  return r;
}

}  // namespace

Report validate_rising_drop(const ExperimentContext& context) {
  const Scene scene = load_scene(context.file);
  const auto& drop = std::get<SphereShape>(scene.blocks[0].shape);
  const auto& block = std::get<BoxShape>(scene.blocks[1].shape);
  const FluidOptions& fluid = scene.fluid;
  const std::size_t of_drop = scene.blocks[0].fluid;
  const SphereInJar jar{.radius = drop.radius,
                        .jar_radius = (block.upper.x() - block.lower.x()) / 2,
                        .excess_density = fluid.density - fluid.rest_density(of_drop),
                        .gravity = fluid.gravity.norm(),
                        .viscosity = fluid.density * fluid.kinematic_viscosity,
                        .inner_viscosity = fluid.rest_density(of_drop) * fluid.viscosity(of_drop)};
  const std::vector<double> whole{1, 0.8, 0.5}, factors = context.options.quick ? std::vector{1.0} : whole;
  Plot plot{"A drop rises in a jar", "path / radius", "speed / known speed", {}};
  std::vector<std::vector<double>> rows, speeds;
  std::vector<Check> rises;
  double farthest = 0;
  for (const double factor : factors) {
    const Scene refined = with_spacing(scene, factor * fluid.spacing);
    const std::string at = at_spacing(refined.fluid.spacing);
    context.say(at);
    const RiseResult r = run_rising(refined, drop, jar.speed());
    plot.curves.push_back({at, r.speed, Look::points});
    rows.push_back({r.spacing, static_cast<double>(r.particles), r.error});
    rises.push_back(at_most(at, std::abs(r.error), kRiseLimit));
    for (const Vec2& p : r.speed) speeds.push_back({r.spacing, p.x(), p.y()});
    farthest = std::max(farthest, r.speed.back().x());
  }
  plot.curves.push_back({"Haberman & Sayre", {{0, 1}, {farthest, 1}}, Look::reference});
  write_file(context.folder / "speeds.csv", csv_text("spacing,path,speed", speeds));
  write_file(context.folder / "summary.csv", csv_text("spacing,particles,error", rows));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format(
      "`{}`: a drop of {:.3g} times the density and {:.3g} times the dynamic viscosity of the liquid around "
      "it, in a "
      "jar "
      "{:.3g} times as wide. In liquid without bounds its speed would be {:.4g} m/s, in the jar it is {:.4g} "
      "m/s.",
      context.file.filename().string(), fluid.rest_density(of_drop) / fluid.density,
      jar.inner_viscosity / jar.viscosity, jar.jar_radius / jar.radius, jar.unbounded_speed(), jar.speed());
  add_smaller(report, "spacing", spacings_text(scene, factors), spacings_text(scene, whole));
  report.statements = {judged(kRises, rises)};
  add_plots(report, context, context.name, std::vector{plot}, "Speed of the drop on its way.");
  report.files = {"summary.csv", "speeds.csv"};
  return report;
}

}  // namespace kappaflow
