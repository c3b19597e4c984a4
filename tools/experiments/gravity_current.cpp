#include "tools/experiments/gravity_current.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tools/experiments/validation.h"
#include "tools/io/files.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

// Huppert 1982: r = 0.894 (g V^3 / (3 nu))^(1/8) t^(1/8) for a thin current, of constant volume V, of which
// he found 0.894 = (2^10 / (3^4 pi^3))^(1/8).
constexpr double kExponent = 0.125;
const double kCoefficient = std::pow(1024 / (81 * std::pow(std::numbers::pi, 3)), kExponent);

// The solution forgets how the current began slowly, as 1/t, and is one of lubrication: it is
// compared from 1.5 to 2 radii of the ball on, where the current's height at its centre is 0.4 to 0.2 of its
// radius. Five layers of particles between floor and surface make the flux right to about (1/5)^2; the eighth
// root of that is little, and the front itself is known to half a spacing, 2 percent.
constexpr double kFirstRadius = 1.5;        // in radii of the ball
constexpr double kExponentLimit = 0.0125;   // a tenth of the exponent
constexpr double kCoefficientLimit = 0.05;  // relative

// What is claimed; what was fitted is added to the reasons.

const Claim kGoesWithEighthRoot{"Huppert 1982", "The front goes with the eighth root of the time.",
                                "Difference of the exponent fitted from 1.5 radii of the ball on."};
const Claim kHasHuppertsCoefficient{"Huppert 1982", "Its coefficient is 0.894.",
                                    "Relative difference at the end, with the exponent 1/8."};

/// Mean over sectors of the farthest particle from the axis, and half a spacing.
double current_front(const FluidSolver& liquid, const Scene& scene) {
  std::array<double, 36> farthest{};
  for (const Vec3& x : liquid.particles().position) {
    const double turn = std::atan2(x.z(), x.x()) / (2 * std::numbers::pi) + 0.5;
    double& r = farthest[std::min(static_cast<std::size_t>(turn * farthest.size()), farthest.size() - 1)];
    r = std::max(r, std::hypot(x.x(), x.z()));
  }
  double sum = 0;
  for (const double r : farthest) sum += r;
  return sum / static_cast<double>(farthest.size()) + scene.fluid.spacing / 2;
}

struct GravityCurrentResult {
  double spacing;
  std::size_t particles;
  std::vector<Vec2> fronts;  ///< (g V^3 t / (3 nu) [m8], r [m])
  PowerLaw fit;              ///< of those from kFirstRadius on
  double coefficient_error;  ///< of r at the end, relative
};

GravityCurrentResult run_gravity_current(const Scene& scene) {
  FluidSolver liquid = make_liquid(scene);
  const double radius = std::get<SphereShape>(scene.blocks.front().shape).radius;
  const double volume = static_cast<double>(liquid.size()) * std::pow(scene.fluid.spacing, 3);
  const double unit =
      scene.fluid.gravity.norm() * std::pow(volume, 3) / (3 * scene.fluid.kinematic_viscosity);
  GravityCurrentResult r{scene.fluid.spacing, liquid.size(), {}, {}, 0};
  std::vector<Vec2> late;
  // Times that a power law spaces evenly.
  for (double time = 0.2; time < scene.duration * 1.001; time *= std::pow(scene.duration / 0.2, 1.0 / 40)) {
    advance(liquid, std::min(time, scene.duration));
    r.fronts.emplace_back(unit * liquid.time(), current_front(liquid, scene));
    if (r.fronts.back().y() > kFirstRadius * radius) late.push_back(r.fronts.back());
  }
  r.fit = fit_power_law(late);
  const Vec2& end = r.fronts.back();
  r.coefficient_error = end.y() / (kCoefficient * std::pow(end.x(), kExponent)) - 1;
  return r;
}

void judge(const std::vector<GravityCurrentResult>& results, Report& report) {
  std::vector<Check> exponent, coefficient;
  std::string fits;
  for (const GravityCurrentResult& r : results) {
    const std::string at = fmt::format("spacing {:.3g} m", r.spacing);
    exponent.push_back(at_most(at, std::abs(r.fit.exponent - kExponent), kExponentLimit));
    coefficient.push_back(at_most(at, std::abs(r.coefficient_error), kCoefficientLimit));
    fits += fmt::format("{}{}: exponent {:.4f}, coefficient {:.4f}", fits.empty() ? "" : "; ", at,
                        r.fit.exponent, kCoefficient * (1 + r.coefficient_error));
  }
  const auto with_fits = [&](Claim claim) {
    claim.reason += fmt::format(" {}.", fits);
    return claim;
  };
  report.statements = {judged(with_fits(kGoesWithEighthRoot), exponent),
                       judged(with_fits(kHasHuppertsCoefficient), coefficient)};
}

}  // namespace

Report validate_gravity_current(const ExperimentContext& context) {
  const Scene scene = load_scene(context.file);
  const std::vector<double> whole{1.2, 1.0}, factors = context.options.quick ? std::vector{2.0} : whole;
  std::vector<GravityCurrentResult> results;
  std::vector<std::vector<double>> rows, fronts;
  Plot plot{"Front of the current", "r [m]", "r (g V^3 t / (3 nu))^(-1/8)", {}};
  plot.curves.push_back({"Huppert 1982", {{1, kCoefficient}, {2, kCoefficient}}, Look::reference});
  for (const double factor : factors) {
    const Scene refined = with_spacing(scene, factor * scene.fluid.spacing);
    context.say(fmt::format("spacing {:.3g} m", refined.fluid.spacing));
    results.push_back(run_gravity_current(refined));
    const GravityCurrentResult& r = results.back();
    Curve curve{fmt::format("spacing {:.3g} m", r.spacing), {}};
    for (const Vec2& p : r.fronts) curve.points.emplace_back(p.y(), p.y() / std::pow(p.x(), kExponent));
    plot.curves.push_back(std::move(curve));
    rows.push_back({r.spacing, static_cast<double>(r.particles), r.fit.exponent,
                    kCoefficient * (1 + r.coefficient_error), r.coefficient_error});
    for (const Vec2& p : r.fronts) fronts.push_back({r.spacing, p.x(), p.y()});
  }
  write_file(context.folder / "fronts.csv", csv_text("spacing,scaled_time,front", fronts));
  write_file(context.folder / "summary.csv",
             csv_text("spacing,particles,exponent,coefficient,coefficient_error", rows));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format(
      "`{}`: half a ball of viscous liquid spreads on a floor without slip for {:.3g} s. The front is the "
      "farthest "
      "particle from the axis of each of 36 sectors, in the mean, and half a spacing; V is the particles' "
      "volume.",
      context.file.filename().string(), scene.duration);
  add_smaller(report, "spacing", spacings_text(scene, factors), spacings_text(scene, whole));
  judge(results, report);
  add_plots(report, context, context.name, std::vector{plot},
            "The coefficient on the way, and that of the similarity solution.");
  report.files = {"summary.csv", "fronts.csv"};
  return report;
}

}  // namespace kappaflow
