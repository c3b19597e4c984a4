#include "tools/experiments/cooling_film.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "tools/experiments/cooling_column.h"
#include "tools/experiments/plane_flow.h"
#include "tools/experiments/validation.h"
#include "tools/io/files.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

// How often the surface's speed is looked at, and when speeds are compared: after so many of these.
constexpr std::size_t kFilmLooks = 20;
constexpr std::array<std::size_t, 3> kFilmTimes{5, 10, 20};

// The free area of a plane of a lattice is a tenth too small (solver/heat.h). The surface cools by 0.3 of
// what the floor is colder; a tenth of that is half as much in the mean over the layers. The floor adds the
// 0.01 of validate-conduction.
constexpr double kFilmTemperatureLimit = 0.025;  // RMS, relative to what the floor is colder
// In the half spacing at the floor the viscosity is that of the lowest particles; it changes there by
// exp(2.4 / layers) at the end, and more before. That half spacing makes a tenth of the speed at six layers,
// of which up to a half is too much. And the slug slumps, by 0.02 of its thickness in its middle, of which a
// speed takes the square.
constexpr double kFilmSpeedLimit = 0.05;  // RMS, relative to the surface's
constexpr double kFilmWayLimit = 0.04;    // likewise; the two have opposite signs
// Friction and temperature at the floor are of first order.
constexpr double kLeastWayOrder = 0.6;
// Rounding of sums over the particles.
constexpr double kKeptHeatLimit = 1e-6;  // relative to what went through the boundary

const Claim kCoolsAsColumn{"Fourier's law, Newton's law of cooling", "The layer cools as a column does.",
                           "RMS over the particles in the middle at the end, relative to what the floor is "
                           "colder than the liquid was."};
const Claim kSlowsAsColumn{"Giordano & Dingwell 2003, lubrication", "It slows down as its viscosity says.",
                           "RMS likewise, at three times, relative to the surface's speed then; uncooled it "
                           "would not slow down."};
const Claim kGoesAsFar{"lubrication", "It goes as far.",
                       "RMS of the particles' ways at the end, relative to the surface's."};
const Claim kWayConverges{"kappaflow",
                          fmt::format("The ways converge, of order {} or better.", kLeastWayOrder),
                          "Fitted over all resolutions."};
const Claim kBalancesHeat{"first law", "What the liquid loses is what went through its boundary.",
                          "Difference over what went through."};

CoolingLayer layer_of(const Scene& scene) {
  const auto& block = std::get<BoxShape>(scene.blocks.front().shape);
  const HeatOptions& heat = *scene.fluid.heat;
  const HeatProperties& of = heat.fluids.front();
  return {.thickness = block.upper.y() - block.lower.y(),
          .acceleration = scene.fluid.gravity.x(),
          .viscosity = scene.fluid.viscosity(0),
          .law = scene.fluid.temperature_law(0),
          .diffusivity = of.conductivity / (scene.fluid.density * of.specific_heat),
          .conductivity = of.conductivity,
          .first_temperature = heat.temperature,
          .floor_temperature = heat.walls.front().value,
          .air_temperature = heat.ambient_temperature,
          .convection = heat.convection};
}

struct CoolingFilmResult {
  int layers;  ///< of particles
  std::size_t particles;
  std::vector<Vec2> temperatures, ways;                     ///< (height over thickness, [K]), (the same, [m])
  std::array<std::vector<Vec2>, kFilmTimes.size()> speeds;  ///< likewise [m/s]
  std::vector<Vec2> surface;                                ///< (time [s], speed of the topmost layer [m/s])
  std::array<double, kFilmTimes.size()> speed_errors{};
  double temperature_error = 0, way_error = 0, balance = 0;
};

/// Which particles are in the middle of the slug: a quarter of its length and of its width.
std::vector<std::size_t> middle_of(const std::vector<Vec3>& start, const BoxShape& slug) {
  const Vec3 center = (slug.lower + slug.upper) / 2, size = slug.upper - slug.lower;
  std::vector<std::size_t> middle;
  for (std::size_t i = 0; i < start.size(); ++i)
    if (std::abs(start[i].x() - center.x()) < size.x() / 8 &&
        std::abs(start[i].z() - center.z()) < size.z() / 8)
      middle.push_back(i);
  return middle;
}

/// Mean of the particles in the middle that began above the height.
double surface_speed(const Particles& now, const std::vector<Vec3>& start,
                     const std::vector<std::size_t>& middle, double height) {
  double sum = 0, count = 0;
  for (const std::size_t i : middle)
    if (start[i].y() > height) {
      sum += now.velocity[i].x();
      ++count;
    }
  return sum / count;
}

/// Steps go with the square of the spacing, so that the liquid is thick (solver/viscous_pressure.h) only
/// where and when it has cooled: where all of it is from the start, layers that rest on each other pair up.
Scene with_layers(const Scene& scene, double thickness, int layers) {
  Scene fine = with_spacing(scene, thickness / layers);
  fine.fluid.max_time_step *= std::pow(fine.fluid.spacing / scene.fluid.spacing, 2);
  return fine;
}

CoolingFilmResult run_cooling_film(const Scene& coarse, const CoolingLayer& layer, int layers) {
  const Scene scene = with_layers(coarse, layer.thickness, layers);
  const auto& slug = std::get<BoxShape>(scene.blocks.front().shape);
  FluidSolver liquid = make_liquid(scene);
  CoolingColumn column(layer);
  const std::vector<Vec3> start = liquid.particles().position;
  const std::vector<std::size_t> middle = middle_of(start, slug);
  CoolingFilmResult r{layers, liquid.size(), {}, {}, {}, {}};
  Particles now;
  const auto points = [&](const auto& value) {
    std::vector<Vec2> result;
    result.reserve(middle.size());
    for (const std::size_t i : middle)
      result.emplace_back((now.position[i].y() - slug.lower.y()) / layer.thickness, value(i));
    return result;
  };
  double came = 0;
  for (std::size_t k = 1; k <= kFilmLooks; ++k) {
    const double time = scene.duration * static_cast<double>(k) / kFilmLooks;
    advance(liquid, time, [&](const FluidStep& step) { came += step.heat_from_walls + step.heat_from_air; });
    column.advance(time);
    now = liquid.particles();
    r.surface.emplace_back(time, surface_speed(now, start, middle, slug.upper.y() - scene.fluid.spacing));
    const auto compared = std::ranges::find(kFilmTimes, k);
    if (compared == kFilmTimes.end()) continue;
    const auto which = static_cast<std::size_t>(compared - kFilmTimes.begin());
    r.speeds[which] = points([&](std::size_t i) { return now.velocity[i].x(); });
    r.speed_errors[which] =
        rms_difference(r.speeds[which], [&](double y) { return column.speed(y); }) / column.speed(1);
  }
  const std::vector<double> temperature = liquid.temperatures();
  r.temperatures = points([&](std::size_t i) { return temperature[i]; });
  r.ways = points([&](std::size_t i) { return now.position[i].x() - start[i].x(); });
  r.temperature_error = rms_difference(r.temperatures, [&](double y) { return column.temperature(y); }) /
                        (layer.first_temperature - layer.floor_temperature);
  r.way_error = rms_difference(r.ways, [&](double y) { return column.shift(y); }) / column.shift(1);
  const HeatProperties& of = scene.fluid.heat->fluids.front();
  double gained = 0;
  for (const double t : temperature) gained += t - layer.first_temperature;
  gained *= scene.fluid.density * of.specific_heat * std::pow(scene.fluid.spacing, 3);
  r.balance = std::abs(gained / came - 1);
  return r;
}

void judge(const std::vector<CoolingFilmResult>& results, Report& report) {
  std::vector<Check> temperatures, speeds, ways, balances;
  std::vector<Vec2> by_spacing;
  for (const CoolingFilmResult& r : results) {
    const std::string at = fmt::format("{} layers", r.layers);
    temperatures.push_back(at_most(at, r.temperature_error, kFilmTemperatureLimit));
    for (std::size_t k = 0; k < kFilmTimes.size(); ++k)
      speeds.push_back(at_most(fmt::format("{}, t = {:.3g} s", at, r.surface[kFilmTimes[k] - 1].x()),
                               r.speed_errors[k], kFilmSpeedLimit));
    ways.push_back(at_most(at, r.way_error, kFilmWayLimit));
    balances.push_back(at_most(at, r.balance, kKeptHeatLimit));
    by_spacing.emplace_back(1.0 / r.layers, r.way_error);
  }
  report.statements = {judged(kCoolsAsColumn, temperatures), judged(kSlowsAsColumn, speeds),
                       judged(kGoesAsFar, ways), judged(kBalancesHeat, balances)};
  if (results.size() < 3) return;
  report.statements.push_back(
      judged(kWayConverges, {at_least("at the end", fit_power_law(by_spacing).exponent, kLeastWayOrder)}));
}

/// (value, height) of the column from the floor to the top.
Curve column_curve(const std::string& title, const std::function<double(double)>& value) {
  Curve curve{title, {}, Look::reference};
  for (const Vec2& p : sampled(value, 0, 1)) curve.points.emplace_back(p.y(), p.x());
  return curve;
}

/// Temperatures and ways at the end, and the surface's speed in time, of all resolutions; speeds of the
/// finest.
std::vector<Plot> film_plots(const std::vector<CoolingFilmResult>& results, const CoolingLayer& layer) {
  const CoolingFilmResult& finest = results.back();
  Plot temperatures{"Temperature at the end", "T [K]", "height / thickness", {}},
      speeds{fmt::format("Speed, {} layers", finest.layers), "u [m/s]", "height / thickness", {}},
      ways{"Way at the end", "x [m]", "height / thickness", {}},
      surface{"Speed of the surface", "t [s]", "u [m/s]", {}};
  for (const CoolingFilmResult& r : results) {
    temperatures.curves.push_back(layer_means(r.temperatures, r.layers));
    ways.curves.push_back(layer_means(r.ways, r.layers));
    surface.curves.push_back({fmt::format("{} layers", r.layers), r.surface, Look::points});
  }
  for (std::size_t k = 0; k < kFilmTimes.size(); ++k) {
    Curve curve = layer_means(finest.speeds[k], finest.layers);
    curve.title = fmt::format("{:.3g} s", finest.surface[kFilmTimes[k] - 1].x());
    speeds.curves.push_back(std::move(curve));
  }
  CoolingColumn column(layer);
  const double first = column.speed(1), end = finest.surface.back().x();
  const Curve uncooled = column_curve("", [&](double y) { return first * end * y * (2 - y); });
  Curve in_time{"column", {{0, first}}, Look::reference};
  speeds.curves.push_back(column_curve("column", [&](double y) { return column.speed(y); }));
  constexpr std::size_t kFine = 5;
  for (std::size_t k = 1; k <= kFine * kFilmLooks; ++k) {
    column.advance(end * static_cast<double>(k) / (kFine * kFilmLooks));
    in_time.points.emplace_back(end * static_cast<double>(k) / (kFine * kFilmLooks), column.speed(1));
    if (k % kFine == 0 && std::ranges::find(kFilmTimes, k / kFine) != kFilmTimes.end())
      speeds.curves.push_back(column_curve("", [&](double y) { return column.speed(y); }));
  }
  temperatures.curves.push_back(column_curve("column", [&](double y) { return column.temperature(y); }));
  ways.curves.push_back(column_curve("column", [&](double y) { return column.shift(y); }));
  ways.curves.push_back(uncooled);
  surface.curves.push_back(std::move(in_time));
  return {temperatures, speeds, ways, surface};
}

}  // namespace

Report validate_cooling_film(const ExperimentContext& context) {
  const Scene scene = load_scene(context.file);
  const CoolingLayer layer = layer_of(scene);
  const std::vector<int> whole{6, 8, 10}, chosen = context.options.quick ? std::vector{5} : whole;
  std::vector<CoolingFilmResult> results;
  std::vector<std::vector<double>> rows, profiles;
  for (const int layers : chosen) {
    context.say(fmt::format("{} layers", layers));
    results.push_back(run_cooling_film(scene, layer, layers));
    const CoolingFilmResult& r = results.back();
    rows.push_back({static_cast<double>(layers), static_cast<double>(r.particles), r.temperature_error,
                    r.speed_errors[0], r.speed_errors[1], r.speed_errors[2], r.way_error, r.balance});
    for (std::size_t k = 0; k < r.ways.size(); ++k)
      profiles.push_back({static_cast<double>(layers), r.ways[k].x(), r.temperatures[k].y(),
                          r.speeds.back()[k].y(), r.ways[k].y()});
  }
  write_file(context.folder / "profiles.csv", csv_text("layers,height,temperature,speed,way", profiles));
  write_file(context.folder / "summary.csv",
             csv_text("layers,particles,temperature_error,early_speed_error,middle_speed_error,"
                      "late_speed_error,way_error,balance",
                      rows));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  CoolingColumn column(layer);
  const double first = column.speed(1);
  column.advance(scene.duration);
  report.introduction = fmt::format(
      "`{}`: a long slug of lava on a slope, its floor {:.3g} K colder than it, under the air; {:.3g} "
      "(thickness)^2 / diffusivity. Its middle is held against a column of a wide layer, whose surface slows "
      "down to {:.3g} of its first speed and goes {:.3g} of the way that it would go uncooled.",
      context.file.filename().string(), layer.first_temperature - layer.floor_temperature,
      layer.diffusivity * scene.duration / std::pow(layer.thickness, 2), column.speed(1) / first,
      column.shift(1) / (first * scene.duration));
  add_smaller(report, "layers", fmt::format("{}", fmt::join(chosen, ", ")),
              fmt::format("{}", fmt::join(whole, ", ")));
  judge(results, report);
  add_plots(report, context, context.name, film_plots(results, layer),
            "Means over the layers of particles, and the column: of the speeds also the first ones, of the "
            "ways also "
            "that of a column that does not cool.");
  report.files = {"summary.csv", "profiles.csv"};
  return report;
}

}  // namespace kappaflow
