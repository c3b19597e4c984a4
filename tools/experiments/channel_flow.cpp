#include "tools/experiments/channel_flow.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tools/experiments/plane_flow.h"
#include "tools/experiments/validation.h"
#include "tools/io/files.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

/// A steady profile u(eta), eta from plate to plate in [0, 1], in units of `speed`.
struct SteadyProfile {
  double speed = 1;                        ///< [m/s]
  std::function<double(double)> velocity;  ///< u(eta)
  double plug = 0;                         ///< share of the gap that moves as one
  // For the limits of its error: see error_limit().
  double gradient = 4, curvature = 8;  ///< of Newtonian flow |du/deta| at a plate and |d2u/deta2|
  double sensitivity = 1;              ///< d log(speed) / d log(stress)
  double spread = 0;  ///< share of a spacing's square that is lost by averages of the shear rate
};

/// Between the two plates, the scene's walls from below.
double gap_of(const Scene& scene) {
  return std::get<BoxShape>(scene.walls[1].shape).lower.y() -
         std::get<BoxShape>(scene.walls[0].shape).upper.y();
}

/// s = 2 eta - 1, the force g along the plates: the stress g gap s / 2 over the density is k |u'|^n, so
/// u = U (1 - |s|^(1/n + 1)), U = gap/2 n/(n + 1) (g gap / (2 k))^(1/n).
SteadyProfile power_law_profile(const Scene& scene) {
  const auto law = std::get<HerschelBulkley>(scene.fluid.rheology(0));
  const double half = gap_of(scene) / 2, power = 1 / law.index + 1;
  SteadyProfile p;
  p.speed = half / power * std::pow(scene.fluid.gravity.norm() * half / law.consistency, 1 / law.index);
  p.velocity = [power](double eta) { return 1 - std::pow(std::abs(2 * eta - 1), power); };
  p.sensitivity = 1 / law.index;
  p.spread = power * (power - 1) * (1 - law.index) / law.index;
  return p;
}

/// Where |s| < phi = tau / (g gap / 2) nothing is sheared: u = U, else u = U (1 - ((|s| - phi) / (1 -
/// phi))^2), U = g gap^2 / (8 nu) (1 - phi)^2.
SteadyProfile bingham_profile(const Scene& scene) {
  const auto law = std::get<HerschelBulkley>(scene.fluid.rheology(0));
  const double half = gap_of(scene) / 2, force = scene.fluid.gravity.norm();
  SteadyProfile p;
  p.plug = law.yield_stress / (force * half);
  p.speed = force * half * half / (2 * law.consistency) * std::pow(1 - p.plug, 2);
  p.velocity = [phi = p.plug](double eta) {
    return 1 - std::pow(std::max(0.0, std::abs(2 * eta - 1) - phi) / (1 - phi), 2);
  };
  p.sensitivity = (1 + p.plug) / (1 - p.plug);
  p.spread = 4 / std::pow(1 - p.plug, 2);
  return p;
}

/// The shear rate a of the lower block, which fills half the gap, and b of the upper: nu(a) a = nu b, and
/// (a + b) gap / 2 the difference of the plates' speeds, U and -U.
SteadyProfile carreau_profile(const Scene& scene) {
  SteadyProfile p;
  p.speed = scene.walls.front().motion.velocity(0).linear.norm();
  const double both = 4 * p.speed / gap_of(scene);  // a + b
  const Rheology law = scene.fluid.rheology(scene.blocks[0].fluid);
  const double upper_viscosity = scene.fluid.viscosity(scene.blocks[1].fluid);
  double low = 0, high = both;
  for (int round = 0; round < 100; ++round) {
    const double a = (low + high) / 2;
    const bool too_fast = viscosity_at(law, a) * a > upper_viscosity * (both - a);
    (too_fast ? high : low) = a;
  }
  const double lower = 4 * low / both, upper = 4 - lower;  // in units of U / gap
  p.velocity = [lower, upper](double eta) { return eta < 0.5 ? lower * eta - 1 : 1 - upper * (1 - eta); };
  p.gradient = std::max(lower, upper);
  p.curvature = 0;
  return p;
}

struct ChannelResult {
  int layers;  ///< across the gap
  std::size_t particles;
  std::vector<Vec2> points;  ///< (eta, u) of the particles in the middle
  double error;              ///< RMS
  double plug = 0;           ///< share of the gap, see measured_plug()
  double worst_viscosity;    ///< error of the viscous solves over what is tolerated
};

/// Particles in the middle third of the slug's length and half of its width, away from its free surfaces.
std::vector<Vec2> profile(const FluidSolver& liquid, const Scene& scene, double speed) {
  const auto& block = std::get<BoxShape>(scene.blocks.front().shape);
  const double bottom = std::get<BoxShape>(scene.walls.front().shape).upper.y(), gap = gap_of(scene);
  const Vec3 center = (block.lower + block.upper) / 2, size = block.upper - block.lower;
  const Particles particles = liquid.particles();
  std::vector<Vec2> points;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Vec3& x = particles.position[i];
    if (std::abs(x.x() - center.x()) > size.x() / 6 || std::abs(x.z() - center.z()) > size.z() / 4) continue;
    points.emplace_back((x.y() - bottom) / gap, particles.velocity[i].x() / speed);
  }
  return points;
}

/// Beside the plug sqrt(1 - u / U) is a line in |s|: where it is zero, with U the mean of the inner half of
/// the plug. Least squares through what moves with 0.2 to 0.9 U.
double measured_plug(const std::vector<Vec2>& points, double phi) {
  double speed = 0, inner = 0;
  for (const Vec2& p : points)
    if (std::abs(2 * p.x() - 1) < phi / 2) {
      speed += p.y();
      ++inner;
    }
  speed /= inner;
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const Vec2& p : points) {
    const double share = p.y() / speed, s = std::abs(2 * p.x() - 1);
    if (share < 0.2 || share > 0.9) continue;
    const double root = std::sqrt(1 - share);
    ++n;
    x += s;
    y += root;
    xx += s * s;
    xy += s * root;
  }
  const double slope = (n * xy - x * y) / (n * xx - x * x);
  return x / n - y / n / slope;
}

ChannelResult run_channel(const Scene& coarse, const SteadyProfile& exact, int layers) {
  const Scene scene = with_spacing(coarse, gap_of(coarse) / layers);
  FluidSolver liquid = make_liquid(scene);
  ChannelResult r{layers, liquid.size(), {}, 0, 0, 0};
  advance(liquid, scene.duration, [&](const FluidStep& step) {
    r.worst_viscosity = std::max(r.worst_viscosity, step.viscosity_error);
  });
  r.points = profile(liquid, scene, exact.speed);
  r.error = rms_difference(r.points, exact.velocity);
  if (exact.plug > 0) r.plug = measured_plug(r.points, exact.plug);
  return r;
}

// The stress is as right as that of Newtonian flow (plane_flow.cpp: 0.085 h u' of slip, h^2/8 u'', h =
// 1/layers), and what it is off by counts as often as the speed depends on it. A particle's shear rate is the
// mean of those towards the layers on both sides, and the viscosity of two particles takes the mean of
// theirs: h^2/4 (u')'' too much where it is curved. Summed up over the profile, with the share (1 - n)/n of
// it that reaches u', that is h^2/4 u'' (1 - n)/n at the wall for a power law; for a plug, whose edge is
// spread over a spacing, h^2/2 u''.
double error_limit(const SteadyProfile& exact, int layers) {
  const double h = 1.0 / layers;
  return exact.sensitivity * (0.085 * exact.gradient * h + exact.curvature * h * h / 8) +
         exact.spread * h * h;
}

// The slip at the wall is of first order, and a plug's edge lies between layers.
constexpr double kLeastChannelOrder = 0.6;

const Claim kChannelProfile{"theory of channel flow", "The steady profile is met.",
                            "RMS over the particles in the middle, relative to the largest speed."};
const Claim kPlugIsAsWide{
    "theory of channel flow", "The plug is as wide as it should be.",
    "Difference of its share of the gap; either edge lies within a spacing of where it should."};
const Claim kChannelConverges{
    "kappaflow",
    fmt::format("The profile converges with the spacing, of order {} or better.", kLeastChannelOrder),
    "Fitted over all resolutions, where the profile is curved."};
const Claim kSolvesConverge{
    "kappaflow", "Every viscous solve converges.",
    "The largest error of a step, with the viscosities of the velocities found, over what is tolerated."};

Plot profile_plot(const std::string& title, const SteadyProfile& exact,
                  const std::vector<ChannelResult>& results) {
  Plot plot{title, "u", "y / gap", {}};
  Curve reference{"exact", {}, Look::reference};
  for (const Vec2& p : sampled(exact.velocity, 0, 1)) reference.points.emplace_back(p.y(), p.x());
  plot.curves.push_back(std::move(reference));
  for (const ChannelResult& r : results) plot.curves.push_back(layer_means(r.points, r.layers));
  return plot;
}

void judge(const SteadyProfile& exact, const std::vector<ChannelResult>& results, Report& report) {
  std::vector<Check> errors, plugs, solves;
  for (const ChannelResult& r : results) {
    const std::string at = fmt::format("{} layers", r.layers);
    errors.push_back(at_most(at, r.error, error_limit(exact, r.layers)));
    if (exact.plug > 0) plugs.push_back(at_most(at, std::abs(r.plug - exact.plug), 2.0 / r.layers));
    solves.push_back(at_most(at, r.worst_viscosity, 1));
  }
  report.statements = {judged(kChannelProfile, errors), judged(kSolvesConverge, solves)};
  if (exact.plug > 0) report.statements.push_back(judged(kPlugIsAsWide, plugs));
  if (results.size() < 3 || !(exact.spread > 0)) return;
  std::vector<Vec2> by_spacing;
  by_spacing.reserve(results.size());
  for (const ChannelResult& r : results) by_spacing.emplace_back(1.0 / r.layers, r.error);
  report.statements.push_back(judged(
      kChannelConverges, {at_least("steady", fit_power_law(by_spacing).exponent, kLeastChannelOrder)}));
}

Report validate(const ExperimentContext& context, SteadyProfile (*profile_of)(const Scene&)) {
  const Scene scene = load_scene(context.file);
  const SteadyProfile exact = profile_of(scene);
  std::vector<ChannelResult> results;
  std::vector<std::vector<double>> rows, points;
  const std::vector<int> whole{6, 8, 12}, chosen = context.options.quick ? std::vector{8} : whole;
  for (const int layers : chosen) {
    context.say(fmt::format("{} layers", layers));
    results.push_back(run_channel(scene, exact, layers));
    const ChannelResult& r = results.back();
    rows.push_back({static_cast<double>(r.layers), static_cast<double>(r.particles), r.error,
                    error_limit(exact, r.layers), exact.plug, r.plug, r.worst_viscosity});
    for (const Vec2& p : r.points) points.push_back({static_cast<double>(r.layers), p.x(), p.y()});
  }
  write_file(context.folder / "profiles.csv", csv_text("layers,eta,u", points));
  write_file(context.folder / "summary.csv",
             csv_text("layers,particles,error,limit,exact_plug,plug,viscosity_error", rows));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format(
      "`{}`: a slug of liquid between two plates, its ends and sides free, after {:.3g} s. It moves much "
      "less "
      "than its length, so that the flow in its middle is plane.",
      context.file.filename().string(), scene.duration);
  add_smaller(report, "layers across the gap", fmt::format("{}", fmt::join(chosen, ", ")),
              fmt::format("{}", fmt::join(whole, ", ")));
  judge(exact, results, report);
  add_plots(report, context, context.name, std::vector{profile_plot("steady profile", exact, results)},
            "Means over the layers of particles, and the exact profile.");
  report.files = {"summary.csv", "profiles.csv"};
  return report;
}

}  // namespace

Report validate_power_law(const ExperimentContext& context) {
  return validate(context, power_law_profile);
}

Report validate_bingham(const ExperimentContext& context) {
  return validate(context, bingham_profile);
}

Report validate_carreau(const ExperimentContext& context) {
  return validate(context, carreau_profile);
}

}  // namespace kappaflow
