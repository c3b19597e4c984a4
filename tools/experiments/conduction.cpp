#include "tools/experiments/conduction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/experiments/validation.h"
#include "tools/io/files.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

// The particles of walls lie irregularly, and so does what each conducts: about a tenth at the wall, which
// the layers above see as a tenth of half a spacing.
constexpr double kConductionLimit = 0.02;  // RMS over the layers, relative to the jump of temperature
constexpr double kConductionOrder = 0.9;   // of convergence: 1, that at irregular walls
// The free area of a sphere that is cut out of a lattice is a tenth too large (solver/heat.h), and half of
// the resistance lies at the surface where the Biot number is 1.
constexpr double kCoolingLimit = 0.05;  // of the mean and the middle temperature, relative to the jump
// Rounding of sums over the particles.
constexpr double kBalanceLimit = 1e-6;  // of the heat, relative to what went through the surface

const Claim kConductsAsFourier{
    "Fourier's law", "Heat enters a layer as the series says.",
    "RMS over the layers of the mean over the middle, relative to the jump at the wall."};
const Claim kHeatConverges{"kappaflow", "The error falls with the spacing.",
                           "Order of the error in the spacing."};
const Claim kCoolsAsTheSeries{
    "Newton's law of cooling", "A sphere cools as the series says.",
    "Largest difference over time, relative to the first one between sphere and air."};
const Claim kKeepsHeat{"first law", "What the liquid gains is what came through its boundary.",
                       "Difference over what came through."};

/// What is said of a scene of one material.
struct Heated {
  double diffusivity;  ///< [m2/s]
  double first;        ///< temperature [K]
  double capacity;     ///< of a particle [J/K]

  explicit Heated(const Scene& scene) {
    const HeatOptions& heat = *scene.fluid.heat;
    const HeatProperties& of = heat.fluids.front();
    const double volumetric = scene.fluid.density * of.specific_heat;
    diffusivity = of.conductivity / volumetric;
    first = heat.temperature;
    capacity = volumetric * std::pow(scene.fluid.spacing, 3);
  }
};

double gained(const FluidSolver& liquid, const Heated& heated) {
  double sum = 0;
  for (const double t : liquid.temperatures()) sum += t - heated.first;
  return heated.capacity * sum;
}

/// (T - T_first) / (T_wall - T_first) at the height y over that of the layer.
double known_layer(double y, double fourier) {
  double sum = 1;
  for (int n = 0; n < 200; ++n) {
    const double k = (n + 0.5) * std::numbers::pi;
    sum -= 2 / k * std::sin(k * y) * std::exp(-k * k * fourier);
  }
  return sum;
}

struct LayerResult {
  double spacing;
  std::size_t particles;
  std::vector<Vec2> profile;  ///< (height over that of the layer, temperature likewise)
  double error, balance;
};

/// Means over the particles of each height in the middle of the layer: beside its open sides fewer neighbours
/// conduct.
std::vector<Vec2> layer_profile(const FluidSolver& liquid, const Scene& scene, double jump) {
  const auto& box = std::get<BoxShape>(scene.blocks.front().shape);
  const Vec3 size = box.upper - box.lower, middle = (box.upper + box.lower) / 2;
  const std::vector<Vec3> position = liquid.particles().position;
  const std::vector<double> temperature = liquid.temperatures();
  std::vector<Vec2> sum(static_cast<std::size_t>(std::round(size.y() / scene.fluid.spacing)), Vec2::Zero());
  std::vector<double> count(sum.size(), 0);
  for (std::size_t i = 0; i < position.size(); ++i) {
    const Vec3 from = position[i] - middle;
    if (std::abs(from.x()) > size.x() / 4 || std::abs(from.z()) > size.z() / 4) continue;
    const double y = position[i].y() - box.lower.y();
    const auto layer =
        std::min(static_cast<std::size_t>(std::max(y / scene.fluid.spacing, 0.0)), sum.size() - 1);
    sum[layer] += Vec2(y / size.y(), (temperature[i] - scene.fluid.heat->temperature) / jump);
    count[layer] += 1;
  }
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] /= count[k];
  return sum;
}

LayerResult run_layer(const Scene& scene) {
  const Heated heated(scene);
  const auto& box = std::get<BoxShape>(scene.blocks.front().shape);
  const double height = box.upper.y() - box.lower.y(),
               jump = scene.fluid.heat->walls.front().value - heated.first;
  FluidSolver liquid = make_liquid(scene);
  double came = 0;
  advance(liquid, scene.duration, [&](const FluidStep& step) { came += step.heat_from_walls; });
  LayerResult r{scene.fluid.spacing, liquid.size(), layer_profile(liquid, scene, jump), 0, 0};
  const double fourier = heated.diffusivity * scene.duration / (height * height);
  r.error = rms_difference(r.profile, [&](double y) { return known_layer(y, fourier); });
  r.balance = std::abs(gained(liquid, heated) - came) / came;
  return r;
}

/// The n-th root of mu cot mu = 1 - biot, n = 0, 1, ..., in (n pi, (n + 1) pi).
double sphere_root(int n, double biot) {
  double low = n * std::numbers::pi + 1e-12, high = (n + 1) * std::numbers::pi - 1e-12;
  for (int k = 0; k < 100; ++k) {
    const double mu = (low + high) / 2;
    (mu * std::cos(mu) / std::sin(mu) > 1 - biot ? low : high) = mu;
  }
  return (low + high) / 2;
}

/// (T - T_air) / (T_first - T_air) of the whole sphere and in its middle.
Vec2 known_sphere(double fourier, double biot) {
  Vec2 sum = Vec2::Zero();
  for (int n = 0; n < 60; ++n) {
    const double mu = sphere_root(n, biot), part = std::sin(mu) - mu * std::cos(mu);
    const double share = 4 * part / (2 * mu - std::sin(2 * mu)) * std::exp(-mu * mu * fourier);
    sum += share * Vec2(3 * part / std::pow(mu, 3), 1);
  }
  return sum;
}

struct SphereResult {
  double spacing;
  std::size_t particles;
  std::vector<Vec2> mean, middle;  ///< (Fourier number, temperature as known_sphere() has it)
  double mean_error = 0, middle_error = 0, balance = 0;
};

SphereResult run_sphere(const Scene& scene, double biot) {
  const Heated heated(scene);
  const auto& sphere = std::get<SphereShape>(scene.blocks.front().shape);
  const double air = scene.fluid.heat->ambient_temperature, jump = heated.first - air;
  FluidSolver liquid = make_liquid(scene);
  SphereResult r{scene.fluid.spacing, liquid.size(), {}, {}};
  double came = 0;
  constexpr int kTimes = 20;
  for (int k = 1; k <= kTimes; ++k) {
    advance(liquid, scene.duration * k / kTimes, [&](const FluidStep& step) { came += step.heat_from_air; });
    const std::vector<Vec3> position = liquid.particles().position;
    const std::vector<double> temperature = liquid.temperatures();
    double all = 0, inner = 0, near = 0;
    for (std::size_t i = 0; i < position.size(); ++i) {
      all += (temperature[i] - air) / jump;
      if ((position[i] - sphere.center).norm() > 1.5 * scene.fluid.spacing) continue;
      inner += (temperature[i] - air) / jump;
      near += 1;
    }
    const double fourier = heated.diffusivity * liquid.time() / (sphere.radius * sphere.radius);
    r.mean.emplace_back(fourier, all / static_cast<double>(position.size()));
    r.middle.emplace_back(fourier, inner / near);
    const Vec2 known = known_sphere(fourier, biot);
    r.mean_error = std::max(r.mean_error, std::abs(r.mean.back().y() - known[0]));
    r.middle_error = std::max(r.middle_error, std::abs(r.middle.back().y() - known[1]));
  }
  r.balance = std::abs((gained(liquid, heated) - came) / came);
  return r;
}

double biot_number(const Scene& scene) {
  const HeatOptions& heat = *scene.fluid.heat;
  return heat.convection * std::get<SphereShape>(scene.blocks.front().shape).radius /
         heat.fluids.front().conductivity;
}

}  // namespace

Report validate_conduction(const ExperimentContext& context) {
  const Scene scene = load_scene(context.file);
  const Heated heated(scene);
  const std::vector<double> whole{1, 0.5, 0.25},
      factors = context.options.quick ? std::vector{1.0, 0.5} : whole;
  const double height = std::get<BoxShape>(scene.blocks.front().shape).upper.y() -
                        std::get<BoxShape>(scene.blocks.front().shape).lower.y(),
               fourier = heated.diffusivity * scene.duration / (height * height);
  Plot plot{"Temperature of a layer on a hot wall",
            "height / thickness",
            "(T - T_first) / (T_wall - T_first)",
            {{"series", sampled([&](double y) { return known_layer(y, fourier); }, 0, 1), Look::reference}}};
  std::vector<std::vector<double>> rows, profiles;
  std::vector<Vec2> errors;
  std::vector<Check> error, balance;
  for (const double factor : factors) {
    const Scene refined = with_spacing(scene, factor * scene.fluid.spacing);
    context.say(at_spacing(refined.fluid.spacing));
    const LayerResult r = run_layer(refined);
    plot.curves.push_back({at_spacing(r.spacing), r.profile, Look::points});
    rows.push_back({r.spacing, static_cast<double>(r.particles), r.error, r.balance});
    errors.emplace_back(r.spacing, r.error);
    error.push_back(at_most(at_spacing(r.spacing), r.error, kConductionLimit));
    balance.push_back(at_most(at_spacing(r.spacing), r.balance, kBalanceLimit));
    for (const Vec2& p : r.profile) profiles.push_back({r.spacing, p.x(), p.y()});
  }
  write_file(context.folder / "profiles.csv", csv_text("spacing,height,temperature", profiles));
  write_file(context.folder / "summary.csv", csv_text("spacing,particles,error,balance", rows));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format(
      "`{}`: a layer whose floor is hot from the start and whose top is insulated, at the time "
      "{:.3g} (thickness)^2 / diffusivity.",
      context.file.filename().string(), fourier);
  add_smaller(report, "spacing", spacings_text(scene, factors), spacings_text(scene, whole));
  report.statements = {
      judged(kConductsAsFourier, error),
      judged(kHeatConverges, {at_least("order", fit_power_law(errors).exponent, kConductionOrder)}),
      judged(kKeepsHeat, balance)};
  add_plots(report, context, context.name, std::vector{plot},
            "Mean temperature of the layers against the series.");
  report.files = {"summary.csv", "profiles.csv"};
  return report;
}

Report validate_cooling(const ExperimentContext& context) {
  const Scene scene = load_scene(context.file);
  const double biot = biot_number(scene);
  const std::vector<double> whole{1, 0.5}, factors = context.options.quick ? std::vector{1.0} : whole;
  Plot plot{
      "A sphere cools in the air", "time / (radius^2 / diffusivity)", "(T - T_air) / (T_first - T_air)", {}};
  std::vector<std::vector<double>> rows, times;
  std::vector<Check> error, balance;
  for (const double factor : factors) {
    const Scene refined = with_spacing(scene, factor * scene.fluid.spacing);
    const std::string at = at_spacing(refined.fluid.spacing);
    context.say(at);
    const SphereResult r = run_sphere(refined, biot);
    plot.curves.push_back({"mean, " + at, r.mean, Look::points});
    plot.curves.push_back({"middle, " + at, r.middle, Look::points});
    rows.push_back({r.spacing, static_cast<double>(r.particles), r.mean_error, r.middle_error, r.balance});
    error.push_back(at_most("mean, " + at, r.mean_error, kCoolingLimit));
    error.push_back(at_most("middle, " + at, r.middle_error, kCoolingLimit));
    balance.push_back(at_most(at, r.balance, kBalanceLimit));
    for (std::size_t k = 0; k < r.mean.size(); ++k)
      times.push_back({r.spacing, r.mean[k].x(), r.mean[k].y(), r.middle[k].y()});
  }
  const double last = times.back()[1];
  for (const int which : {0, 1})
    plot.curves.push_back(
        {which == 0 ? "series" : "",
         sampled([&](double fourier) { return known_sphere(fourier, biot)[which]; }, last / 100, last),
         Look::reference});
  write_file(context.folder / "temperatures.csv", csv_text("spacing,time,mean,middle", times));
  write_file(context.folder / "summary.csv",
             csv_text("spacing,particles,mean_error,middle_error,balance", rows));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction =
      fmt::format("`{}`: a sphere with the Biot number {:.3g}; convection times radius over conductivity.",
                  context.file.filename().string(), biot);
  add_smaller(report, "spacing", spacings_text(scene, factors), spacings_text(scene, whole));
  report.statements = {judged(kCoolsAsTheSeries, error), judged(kKeepsHeat, balance)};
  add_plots(report, context, context.name, std::vector{plot}, "Temperatures against the series.");
  report.files = {"summary.csv", "temperatures.csv"};
  return report;
}

}  // namespace kappaflow
