#include "tools/experiments/hydrostatic.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/experiments/validation.h"
#include "tools/files.h"
#include "tools/plot.h"

namespace kappaflow {
namespace {

// Limits. The density solve leaves compressions of its tolerance, 1e-4, which no pressure shows; a pressure
// field that is exact for a lattice in balance is off where wall particles are irregular. A level is known to
// a fraction of a spacing: the contact layer may lie a quarter of a spacing nearer to the floor or farther.
constexpr double kPressureLimit = 0.02;  // RMS over the layers, relative to rho g depth
constexpr double kSlopeLimit = 0.02;     // of dp/dy against rho g
constexpr double kLevelLimit = 0.25;     // [spacings]
constexpr double kSpeedLimit = 1e-3;     // of the fastest particle, relative to sqrt(g depth)

struct Basin {
  double depth, bottom;
};

Basin basin_of(const Scene& scene) {
  const auto& box = std::get<BoxShape>(scene.blocks.front().shape);
  return {box.upper.y() - box.lower.y(), box.lower.y()};
}

struct Result {
  double spacing;
  std::size_t particles;
  std::vector<Vec2> profile;  ///< (height, mean pressure over rho g depth) of layers one spacing thick
  double pressure_error, slope_error, level_error, speed;
};

/// Mean pressure of horizontal layers `thickness` high, over rho g depth; the mean height of their particles
/// over the depth.
std::vector<Vec2> layers(const FluidSolver& liquid, const Scene& scene) {
  const Basin basin = basin_of(scene);
  const double thickness = scene.fluid.spacing,
               full = scene.fluid.density * scene.fluid.gravity.norm() * basin.depth;
  const Particles particles = liquid.particles();
  const std::vector<float> pressure = liquid.pressures();
  std::vector<Vec2> sum;
  std::vector<double> count;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double height = particles.position[i].y() - basin.bottom;
    const auto layer = static_cast<std::size_t>(std::max(height / thickness, 0.0));
    if (layer >= sum.size()) sum.resize(layer + 1, Vec2::Zero()), count.resize(layer + 1, 0);
    sum[layer] += Vec2(height / basin.depth, static_cast<double>(pressure[i]) / full);
    ++count[layer];
  }
  std::vector<Vec2> profile;
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (count[k] > 0) profile.emplace_back(sum[k] / count[k]);
  return profile;
}

/// Slope of the least-squares line through the points.
double slope(std::span<const Vec2> points) {
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : points) mean += p / static_cast<double>(points.size());
  double xx = 0, xy = 0;
  for (const Vec2& p : points) {
    xx += (p - mean).x() * (p - mean).x();
    xy += (p - mean).x() * (p - mean).y();
  }
  return xy / xx;
}

Result run_at(const Scene& scene) {
  FluidSolver liquid = make_liquid(scene);
  double speed = 0;
  advance(liquid, scene.duration, [&](const FluidStep& step) { speed = step.fastest; });
  const Basin basin = basin_of(scene);
  Result r{scene.fluid.spacing, liquid.size(), layers(liquid, scene), 0, 0, 0, 0};
  r.pressure_error = rms_difference(r.profile, [](double height) { return 1 - height; });
  r.slope_error = std::abs(-slope(r.profile) - 1);
  // Half a spacing above the uppermost layer of particles.
  r.level_error = std::abs((r.profile.back().x() - 1) * basin.depth / r.spacing + 0.5);
  r.speed = speed / std::sqrt(scene.fluid.gravity.norm() * basin.depth);
  return r;
}

void judge(const std::vector<Result>& results, Report& report) {
  std::vector<Bounded> pressure, level, speed;
  for (const Result& r : results) {
    const std::string at = fmt::format("spacing {:.3g} m", r.spacing);
    pressure.push_back({"error, " + at, r.pressure_error, kPressureLimit});
    pressure.push_back({"slope, " + at, r.slope_error, kSlopeLimit});
    level.push_back({at, r.level_error, kLevelLimit});
    speed.push_back({at, r.speed, kSpeedLimit});
  }
  report.statements = {
      within_limits(
          "hydrostatics", "p = rho g (depth).", pressure,
          "RMS over the layers relative to the pressure at the floor; relative error of the slope."),
      within_limits("hydrostatics", "The level of a liquid at rest stays.", level, "In particle spacings."),
      within_limits("hydrostatics", "The liquid is at rest.", speed, "Fastest particle over sqrt(g depth).")};
}

}  // namespace

Report validate_hydrostatic(const ExperimentContext& context) {
  const Scene scene = load_scene(context.file);
  std::vector<Result> results;
  Plot plot{"Pressure at rest", "height / depth", "p / (rho g depth)", {{"rho g h", {{0, 1}, {1, 0}}}}};
  std::vector<std::vector<double>> rows, profiles;
  for (const double factor : context.options.quick ? std::vector{1.0} : std::vector{1.0, 0.5}) {
    const Scene refined = with_spacing(scene, factor * scene.fluid.spacing);
    context.say(fmt::format("spacing {:.3g} m", refined.fluid.spacing));
    results.push_back(run_at(refined));
    const Result& r = results.back();
    plot.curves.push_back({fmt::format("spacing {:.3g} m", r.spacing), r.profile});
    rows.push_back({r.spacing, static_cast<double>(r.particles), r.pressure_error, r.slope_error,
                    r.level_error, r.speed});
    for (const Vec2& p : r.profile) profiles.push_back({r.spacing, p.x(), p.y()});
  }
  draw_plots(context.folder, context.name, std::vector{plot});
  write_file(context.folder / "profiles.csv", csv_text("spacing,height,pressure", profiles));
  write_file(context.folder / "summary.csv",
             csv_text("spacing,particles,pressure_error,slope_error,level_error,speed", rows));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format("`{}`: liquid 1 m deep from wall to wall of a basin, after {:.3g} s.",
                                    context.file.filename().string(), scene.duration);
  judge(results, report);
  report.figures = {{context.name + ".png", "Mean pressure of the layers against the depth."}};
  report.files = {"summary.csv", "profiles.csv", context.name + ".gp"};
  return report;
}

}  // namespace kappaflow
