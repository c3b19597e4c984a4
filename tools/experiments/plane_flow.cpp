#include "tools/experiments/plane_flow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/experiments/validation.h"
#include "tools/io/files.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

constexpr double kEarly = 0.1, kLate = 1;  // when profiles are compared, in units of gap^2 / viscosity

/// A flow between plates at eta = 0 and 1, with tau = viscosity t / gap^2, and u in units of the scene's
/// speed.
struct PlaneFlow {
  double (*speed)(const Scene& scene, double gap);  ///< the unit of u [m/s]
  double (*velocity)(double eta, double tau);  ///< series solution of u_tau = u_eta,eta + force, from rest
  double wall_gradient;                        ///< |du/deta| of the steady profile at a plate
  double curvature;                            ///< |d2u/deta2| of it
};

double poiseuille(double eta, double tau) {
  double u = 4 * eta * (1 - eta);
  for (int k = 1; k < 200; k += 2) {
    const double wave = k * std::numbers::pi;
    u -= 32 / std::pow(wave, 3) * std::sin(wave * eta) * std::exp(-wave * wave * tau);
  }
  return u;
}

double couette(double eta, double tau) {
  double u = 2 * eta - 1;
  for (int k = 1; k < 200; ++k) {
    const double wave = 2 * k * std::numbers::pi, sign = k % 2 == 0 ? 1 : -1;
    u += 4 / wave * sign * std::sin(wave * (eta - 0.5)) * std::exp(-wave * wave * tau);
  }
  return u;
}

/// The middle of the profile: g gap^2 / (8 nu).
double poiseuille_speed(const Scene& scene, double gap) {
  return scene.fluid.gravity.norm() * gap * gap / (8 * scene.fluid.kinematic_viscosity);
}

/// That of the plates.
double couette_speed(const Scene& scene, double) {
  return scene.walls.front().motion.velocity(0).linear.norm();
}

struct PlaneFlowResult {
  int layers;  ///< across the gap
  std::size_t particles;
  std::vector<Vec2> early, late;  ///< (eta, u) of the particles in the middle
  double early_error, late_error;
};

/// Particles in the middle third of the slug's length and half of its width, away from its free surfaces.
std::vector<Vec2> profile(const FluidSolver& liquid, const BoxShape& slug, double speed) {
  const Vec3 center = (slug.lower + slug.upper) / 2, size = slug.upper - slug.lower;
  const Particles particles = liquid.particles();
  std::vector<Vec2> points;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Vec3 x = particles.position[i] - center;
    if (std::abs(x.x()) > size.x() / 6 || std::abs(x.z()) > size.z() / 4) continue;
    points.emplace_back(x.y() / size.y() + 0.5, particles.velocity[i].x() / speed);
  }
  return points;
}

/// The error of the time integration is of first order too: the step goes with the spacing.
Scene at_resolution(const Scene& scene, int layers, double gap) {
  Scene fine = with_spacing(scene, gap / layers);
  fine.fluid.max_time_step *= fine.fluid.spacing / scene.fluid.spacing;
  return fine;
}

PlaneFlowResult run_plane_flow(const Scene& coarse, const PlaneFlow& flow, int layers) {
  const auto& slug = std::get<BoxShape>(coarse.blocks.front().shape);
  const double gap = slug.upper.y() - slug.lower.y(),
               viscous_time = gap * gap / coarse.fluid.kinematic_viscosity;
  const double speed = flow.speed(coarse, gap);
  FluidSolver liquid = make_liquid(at_resolution(coarse, layers, gap));
  PlaneFlowResult r{layers, liquid.size(), {}, {}, 0, 0};
  const auto error = [&](double tau, std::vector<Vec2>& points) {
    advance(liquid, tau * viscous_time);
    points = profile(liquid, slug, speed);
    return rms_difference(points, [&](double eta) { return flow.velocity(eta, tau); });
  };
  r.early_error = error(kEarly, r.early);
  r.late_error = error(kLate, r.late);
  return r;
}

// Wall friction is the finite-volume form of the shear stress: exact for a linear profile, and off by h^2/8
// u'' for a curved one, h = 1/layers. Liquid rests half a spacing from the plate to about 0.05 spacings, and
// the sum over irregular wall particles is right to 7 percent there: a slip of (0.05 + 0.07/2) h u'.
double steady_limit(const PlaneFlow& flow, int layers) {
  const double h = 1.0 / layers;
  return 0.085 * flow.wall_gradient * h + flow.curvature * h * h / 8;
}

// On the way the implicit time step adds its first-order error, and the density of the lattice settles.
constexpr double kEarlyLimit = 0.05;

// The slip at the wall and the implicit time step are of first order.
constexpr double kLeastOrder = 0.9;

// What is claimed.

const Claim kSteadyProfile{
    "Navier-Stokes, series solution", "The steady profile is met.",
    "RMS over the particles in the middle, relative to the unit of speed, at tau = 1."};
const Claim kProfileOnTheWay{"Navier-Stokes, series solution", "So is the profile on the way there.",
                             "The same at tau = 0.1."};
const Claim kProfileConverges{
    "kappaflow", fmt::format("The profile converges with the spacing, of order {} or better.", kLeastOrder),
    "Fitted over all resolutions. A linear profile is exact at every resolution, but for the irregularity of "
    "the wall particles, so its order is not judged."};

Plot profile_plot(const std::string& title, const PlaneFlow& flow,
                  const std::vector<PlaneFlowResult>& results, double tau,
                  std::vector<Vec2> PlaneFlowResult::*points) {
  Plot plot{title, "u", "y / gap", {}};
  Curve reference{"exact", {}, Look::reference};
  for (const Vec2& p : sampled([&](double eta) { return flow.velocity(eta, tau); }, 0, 1))
    reference.points.emplace_back(p.y(), p.x());
  plot.curves.push_back(std::move(reference));
  for (const PlaneFlowResult& r : results) plot.curves.push_back(layer_means(r.*points, r.layers));
  return plot;
}

void judge(const PlaneFlow& flow, const std::vector<PlaneFlowResult>& results, Report& report) {
  std::vector<Check> early, late;
  std::vector<Vec2> early_errors, late_errors;
  for (const PlaneFlowResult& r : results) {
    const std::string at = fmt::format("{} layers", r.layers);
    early.push_back(at_most(at, r.early_error, kEarlyLimit));
    late.push_back(at_most(at, r.late_error, steady_limit(flow, r.layers)));
    early_errors.emplace_back(1.0 / r.layers, r.early_error);
    late_errors.emplace_back(1.0 / r.layers, r.late_error);
  }
  report.statements = {judged(kSteadyProfile, late), judged(kProfileOnTheWay, early)};
  if (results.size() < 3) return;
  const double early_order = fit_power_law(early_errors).exponent,
               late_order = fit_power_law(late_errors).exponent;
  std::vector<Check> checks{at_least("tau = 0.1", early_order, kLeastOrder)};
  if (flow.curvature > 0) checks.push_back(at_least("tau = 1", late_order, kLeastOrder));
  report.statements.push_back(judged(kProfileConverges, checks));
}

Report validate(const ExperimentContext& context, const PlaneFlow& flow) {
  const Scene scene = load_scene(context.file);
  std::vector<PlaneFlowResult> results;
  std::vector<std::vector<double>> rows, points;
  const std::vector<int> whole{6, 8, 12, 16}, chosen = context.options.quick ? std::vector{6, 8} : whole;
  for (const int layers : chosen) {
    context.say(fmt::format("{} layers", layers));
    results.push_back(run_plane_flow(scene, flow, layers));
    const PlaneFlowResult& r = results.back();
    rows.push_back({static_cast<double>(r.layers), static_cast<double>(r.particles), r.early_error,
                    r.late_error, steady_limit(flow, r.layers)});
    for (const Vec2& p : r.late) points.push_back({static_cast<double>(r.layers), p.x(), p.y()});
  }
  write_file(context.folder / "profiles.csv", csv_text("layers,eta,u", points));
  write_file(context.folder / "summary.csv",
             csv_text("layers,particles,early_error,late_error,late_limit", rows));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format(
      "`{}`: a slug of liquid between two plates, six gaps long, its ends and sides free. It moves much less "
      "than a "
      "gap, so that the flow in its middle is plane; tau = viscosity t / gap^2.",
      context.file.filename().string());
  add_smaller(report, "layers across the gap", fmt::format("{}", fmt::join(chosen, ", ")),
              fmt::format("{}", fmt::join(whole, ", ")));
  judge(flow, results, report);
  add_plots(report, context, context.name,
            std::vector{profile_plot("tau = 0.1", flow, results, kEarly, &PlaneFlowResult::early),
                        profile_plot("tau = 1", flow, results, kLate, &PlaneFlowResult::late)},
            "Means over the layers of particles, and the series solution.");
  report.files = {"summary.csv", "profiles.csv"};
  return report;
}

}  // namespace

Curve layer_means(std::span<const Vec2> points, int layers) {
  std::vector<Vec2> sum(static_cast<std::size_t>(layers), Vec2::Zero());
  std::vector<double> count(sum.size(), 0);
  for (const Vec2& p : points) {
    const auto layer = static_cast<std::size_t>(std::clamp(p.x() * layers, 0.0, layers - 0.5));
    sum[layer] += Vec2(p.y(), p.x());
    ++count[layer];
  }
  Curve curve{fmt::format("{} layers", layers), {}, Look::points};
  for (std::size_t k = 0; k < sum.size(); ++k)
    if (count[k] > 0) curve.points.emplace_back(sum[k] / count[k]);
  return curve;
}

Report validate_poiseuille(const ExperimentContext& context) {
  return validate(context, {poiseuille_speed, poiseuille, 4, 8});
}

Report validate_couette(const ExperimentContext& context) {
  return validate(context, {couette_speed, couette, 2, 0});
}

}  // namespace kappaflow
