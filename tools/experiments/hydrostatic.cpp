#include "tools/experiments/hydrostatic.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/experiments/validation.h"
#include "tools/io/files.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

// Limits. Sums over some thirty neighbours in disorder are good to a few percent, and so is the pressure that
// carries the weight above, of which the lowest layers know all. The density solve stops at a mean
// compression of its tolerance, 1e-4. Of one sign all over the depth H that would be an acceleration of
// 1e-4 H / dt^2, 0.4 g here; as the pressure is fitted as a whole, what is left changes its sign on the way.
constexpr double kPressureLimit = 0.05;  // RMS over the layers of the mean over time, relative to rho g depth
constexpr double kSlopeLimit = 0.05;     // of its gradient against rho g
constexpr double kFluctuationLimit =
    0.05;  // standard deviation over time of the mean pressure, relative to its mean
constexpr double kLevelLimit =
    0.25;  // [spacings]: walls are irregular, and liquid fills what room they leave
constexpr double kRestSpeedLimit = 0.01;  // RMS over the particles, relative to sqrt(g depth)

// What is claimed.

const Claim kPressureIsHydrostatic{
    "hydrostatics", "p = rho g (depth).",
    "Mean over the second half of the time: RMS over the layers relative to the pressure at the floor; "
    "relative "
    "error of the slope. Fluctuation: standard deviation of the mean pressure over time."};
const Claim kLevelStays{"hydrostatics", "The level of a liquid at rest stays.",
                        "Twice the mean height, in particle spacings."};
const Claim kLiquidIsAtRest{"hydrostatics", "The liquid is at rest.",
                            "RMS over the particles relative to sqrt(g depth)."};

struct Basin {
  double depth, bottom;
};

Basin basin_of(const Scene& scene) {
  const auto& box = std::get<BoxShape>(scene.blocks.front().shape);
  return {box.upper.y() - box.lower.y(), box.lower.y()};
}

struct HydrostaticResult {
  double spacing;
  std::size_t particles;
  std::vector<Vec2> profile;  ///< (height, mean pressure over rho g depth) of layers one spacing thick
  double pressure_error, slope_error, fluctuation, level_error, speed;
};

/// Means over time and over the particles of layers one spacing thick.
class Layers {
 public:
  explicit Layers(const Scene& scene)
      : basin_(basin_of(scene)),
        thickness_(scene.fluid.spacing),
        full_(scene.fluid.density * scene.fluid.gravity.norm() * basin_.depth) {}

  /// Returns the mean pressure of all particles over rho g depth.
  double add(const FluidSolver& liquid, double time_step) {
    const Particles particles = liquid.particles();
    const std::vector<float> pressure = liquid.pressures();
    double mean = 0;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const double height = particles.position[i].y() - basin_.bottom,
                   p = static_cast<double>(pressure[i]) / full_;
      const auto layer = static_cast<std::size_t>(std::max(height / thickness_, 0.0));
      if (layer >= weight_.size()) sum_.resize(layer + 1, Vec2::Zero()), weight_.resize(layer + 1, 0);
      sum_[layer] += time_step * Vec2(height / basin_.depth, p);
      weight_[layer] += time_step;
      mean += p / static_cast<double>(particles.size());
    }
    return mean;
  }
  /// (height over depth, pressure over rho g depth), from the floor upwards.
  std::vector<Vec2> profile() const {
    std::vector<Vec2> points;
    for (std::size_t k = 0; k < sum_.size(); ++k)
      if (weight_[k] > 0) points.emplace_back(sum_[k] / weight_[k]);
    return points;
  }

 private:
  Basin basin_;
  double thickness_, full_;
  std::vector<Vec2> sum_;
  std::vector<double> weight_;
};

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

HydrostaticResult run_hydrostatic(const Scene& scene) {
  FluidSolver liquid = make_liquid(scene);
  Layers layers(scene);
  double time = 0, sum = 0, square = 0;
  advance(liquid, scene.duration / 2);
  advance(liquid, scene.duration, [&](const FluidStep& step) {
    const double mean = layers.add(liquid, step.time_step);
    time += step.time_step;
    sum += step.time_step * mean;
    square += step.time_step * mean * mean;
  });
  const Basin basin = basin_of(scene);
  const Particles particles = liquid.particles();
  double height = 0, energy = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    height += (particles.position[i].y() - basin.bottom) / static_cast<double>(particles.size());
    energy += particles.velocity[i].squaredNorm() / static_cast<double>(particles.size());
  }
  HydrostaticResult r{scene.fluid.spacing, liquid.size(), layers.profile(), 0, 0, 0, 0, 0};
  r.pressure_error = rms_difference(r.profile, [](double y) { return 1 - y; });
  r.slope_error = std::abs(-slope(r.profile) - 1);
  r.fluctuation = std::sqrt(std::max(square / time - std::pow(sum / time, 2), 0.0)) / (sum / time);
  r.level_error = std::abs(2 * height - basin.depth) / r.spacing;
  r.speed = std::sqrt(energy / (scene.fluid.gravity.norm() * basin.depth));
  return r;
}

void judge(const std::vector<HydrostaticResult>& results, Report& report) {
  std::vector<Check> pressure, level, speed;
  for (const HydrostaticResult& r : results) {
    const std::string at = fmt::format("spacing {:.3g} m", r.spacing);
    pressure.push_back(at_most("error, " + at, r.pressure_error, kPressureLimit));
    pressure.push_back(at_most("slope, " + at, r.slope_error, kSlopeLimit));
    pressure.push_back(at_most("fluctuation, " + at, r.fluctuation, kFluctuationLimit));
    level.push_back(at_most(at, r.level_error, kLevelLimit));
    speed.push_back(at_most(at, r.speed, kRestSpeedLimit));
  }
  report.statements = {judged(kPressureIsHydrostatic, pressure), judged(kLevelStays, level),
                       judged(kLiquidIsAtRest, speed)};
}

}  // namespace

Report validate_hydrostatic(const ExperimentContext& context) {
  const Scene scene = load_scene(context.file);
  const std::vector<double> whole{1.0, 0.5}, factors = context.options.quick ? std::vector{1.0} : whole;
  std::vector<HydrostaticResult> results;
  Plot plot{"Pressure at rest",
            "height / depth",
            "p / (rho g depth)",
            {{"exact", {{0, 1}, {1, 0}}, Look::reference}}};
  std::vector<std::vector<double>> rows, profiles;
  for (const double factor : factors) {
    const Scene refined = with_spacing(scene, factor * scene.fluid.spacing);
    context.say(fmt::format("spacing {:.3g} m", refined.fluid.spacing));
    results.push_back(run_hydrostatic(refined));
    const HydrostaticResult& r = results.back();
    plot.curves.push_back({fmt::format("spacing {:.3g} m", r.spacing), r.profile, Look::points});
    rows.push_back({r.spacing, static_cast<double>(r.particles), r.pressure_error, r.slope_error,
                    r.fluctuation, r.level_error, r.speed});
    for (const Vec2& p : r.profile) profiles.push_back({r.spacing, p.x(), p.y()});
  }
  write_file(context.folder / "profiles.csv", csv_text("spacing,height,pressure", profiles));
  write_file(context.folder / "summary.csv",
             csv_text("spacing,particles,pressure_error,slope_error,fluctuation,level_error,speed", rows));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format("`{}`: liquid 1 m deep from wall to wall of a basin, after {:.3g} s.",
                                    context.file.filename().string(), scene.duration);
  add_smaller(report, "spacing", spacings_text(scene, factors), spacings_text(scene, whole));
  judge(results, report);
  add_plots(report, context, context.name, std::vector{plot},
            "Mean pressure of the layers against the depth.");
  report.files = {"summary.csv", "profiles.csv"};
  return report;
}

}  // namespace kappaflow
