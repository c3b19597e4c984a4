#include "tools/experiments/incline.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "solver/emitter.h"
#include "tools/experiments/peers.h"
#include "tools/experiments/thin_film.h"
#include "tools/experiments/validation.h"
#include "tools/io/files.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

// The film is three to five layers of particles thick. Friction at the plane and the shear above it are right
// to about a half over the layers (validate-poiseuille), a tenth to a sixth of the flux, and lengths go with
// its eighth root at first, with its third in the end. A front is known to half a spacing, 1 percent, and the
// figure was read to about as much.
constexpr double kOutlineLimit = 0.06;       // RMS over the measured points, relative to their distance
constexpr double kInclineFrontLimit = 0.08;  // RMS over time of each front likewise, near the source too
// Theory against measurement: the reading, the cells, and what the film is too thick for lubrication.
constexpr double kTheoryLimit = 0.04;

constexpr double kFrontSector = 0.06;  // [rad] half of the sector in which the farthest particle is the front
constexpr std::size_t kFrontIntervals = 32;  // how often fronts are looked at
constexpr double kComparedFrom = 8;          // [s]: before, the hole is no point
constexpr double kQuickDuration = 0.5;       // of the scene's: before any outline was measured
// [m] Of the theory's cells; 1.5 mm change fronts by 1 percent, by 2 up the slope.
constexpr double kFilmCell = 0.0025;

const Claim kIsWhereMeasured{"", "The outline is where it was measured.",
                             "RMS over the measured points of the difference in distance from the source in "
                             "their directions, relative to the distance."};
const Claim kFollowsTheory{
    "Lister 1992, thin-film theory", "The fronts run as the theory of thin films says.",
    fmt::format("RMS over time, from {} s on, relative to the distance.", kComparedFrom)};
const Claim kTheoryIsRight{"", "So was the theory where it was measured.",
                           "As the first statement, of the theory at all measured times."};
const Claim kInclineConverges{"kappaflow", "Smaller spacings are nearer to the theory.",
                              "Their RMS over all fronts, over that of the coarsest."};

/// Down the slope, across it and up.
struct Front {
  const char* name;
  double direction;  ///< from down the slope [rad]
};
constexpr std::array kFronts{Front{"down", 0}, Front{"across", std::numbers::pi / 2},
                             Front{"up", std::numbers::pi}};

Vec2 unit_vector(double direction) {
  return {std::cos(direction), std::sin(direction)};
}

/// What was seen of liquid that spreads.
struct Spreading {
  std::array<std::vector<Vec2>, kFronts.size()> fronts;  ///< (time [s], distance from the source [m])
  std::vector<std::vector<Vec2>> outlines;               ///< at the measured times
  std::vector<double> outline_errors;                    ///< then, see kIsWhereMeasured
};

/// How far the liquid reaches in a direction [m].
using Reach = std::function<double(double)>;

std::vector<Vec2> outline_of(const Reach& reach) {
  constexpr int kDirections = 60;
  std::vector<Vec2> points;
  points.reserve(kDirections + 1);
  for (int k = 0; k <= kDirections; ++k) {
    const double direction = std::numbers::pi * k / kDirections;
    points.emplace_back(reach(direction) * unit_vector(direction));
  }
  return points;
}

double outline_error(const MeasuredOutlines::Outline& measured, const Reach& reach) {
  std::vector<Vec2> ratios;
  ratios.reserve(measured.points.size());
  for (const Vec2& p : measured.points) {
    const double direction = std::atan2(p.y(), p.x());
    ratios.emplace_back(direction, reach(direction) / p.norm());
  }
  return rms_difference(ratios, [](double) { return 1.0; });
}

/// Looks at fronts every `interval`, and at outlines when they were measured, until `end` [s].
Spreading observed(const MeasuredOutlines& measured, double interval, double end,
                   const std::function<void(double)>& advance_to, const Reach& reach) {
  Spreading seen;
  auto next = measured.outlines.begin();
  const auto until = [&](double time) {
    for (; next != measured.outlines.end() && next->time <= time; ++next) {
      advance_to(next->time);
      seen.outlines.push_back(outline_of(reach));
      seen.outline_errors.push_back(outline_error(*next, reach));
    }
    advance_to(time);
  };
  for (double time = interval; time < end + interval / 2; time += interval) {
    until(time);
    for (std::size_t k = 0; k < kFronts.size(); ++k)
      seen.fronts[k].emplace_back(time, reach(kFronts[k].direction));
  }
  return seen;
}

/// Half of the plane, which is symmetric, and large enough for all that was measured.
ThinFilm make_film(const Scene& scene, const MeasuredOutlines& measured, double cell) {
  Vec2 lower(0, 0), upper(0, 0);
  for (const auto& outline : measured.outlines)
    for (const Vec2& p : outline.points) {
      lower = lower.cwiseMin(1.5 * p);
      upper = upper.cwiseMax(1.2 * p);
    }
  const Emitter& emitter = scene.fluid.emitters.front();
  const auto& mouth = std::get<RectangleMouth>(emitter.mouth);
  ThinFilm film({scene.fluid.kinematic_viscosity, scene.fluid.gravity.x(), -scene.fluid.gravity.y()},
                {{lower.x(), 0},
                 cell,
                 static_cast<std::size_t>((upper.x() - lower.x()) / cell),
                 static_cast<std::size_t>(upper.y() / cell)});
  const Vec2 half(mouth.height / 2, mouth.width / 2);
  film.set_source(-half, half, emitter.speed);
  return film;
}

Spreading run_film(const Scene& scene, const MeasuredOutlines& measured, double cell) {
  ThinFilm film = make_film(scene, measured, cell);
  return observed(
      measured, scene.duration / kFrontIntervals, measured.outlines.back().time,
      [&](double time) { film.advance(time); },
      [&](double direction) {
        return film.reach({0, 0}, unit_vector(direction));
      });
}

/// How far the farthest particle above the plane in a direction is from the source, in the mean of the two
/// halves of the plane, and half a spacing.
double particle_reach(const std::vector<Vec3>& position, double direction, double spacing) {
  std::array<double, 2> farthest{};
  for (const Vec3& x : position) {
    if (x.y() < 0 || std::abs(std::atan2(std::abs(x.z()), x.x()) - direction) > kFrontSector) continue;
    double& r = farthest[x.z() < 0 ? 0 : 1];
    r = std::max(r, std::hypot(x.x(), x.z()));
  }
  return (farthest[0] + farthest[1] + spacing) / 2;
}

/// With the flow rate of the scene's mouth, whatever number of particles fits into it.
Scene with_flow_rate(const Scene& coarse, double spacing) {
  Scene scene = with_spacing(coarse, spacing);
  Emitter& emitter = scene.fluid.emitters.front();
  const auto& mouth = std::get<RectangleMouth>(emitter.mouth);
  const auto layer = static_cast<double>(emitter_layer(emitter, spacing).size());
  emitter.speed *= mouth.width * mouth.height / (layer * spacing * spacing);
  return scene;
}

struct InclineResult {
  double spacing;
  std::size_t particles;
  Spreading seen;
  std::array<double, kFronts.size()> front_errors{};

  double front_error() const {
    double sum = 0;
    for (const double error : front_errors) sum += error * error;
    return std::sqrt(sum / static_cast<double>(kFronts.size()));
  }
};

InclineResult run_incline(const Scene& scene, const MeasuredOutlines& measured, const Spreading& theory) {
  FluidSolver liquid = make_liquid(scene);
  std::vector<Vec3> position;
  InclineResult r{scene.fluid.spacing, 0, {}};
  r.seen = observed(
      measured, scene.duration / kFrontIntervals, scene.duration,
      [&](double time) {
        advance(liquid, time);
        position = liquid.particles().position;
      },
      [&](double direction) { return particle_reach(position, direction, scene.fluid.spacing); });
  r.particles = liquid.size();
  for (std::size_t k = 0; k < kFronts.size(); ++k) {
    std::vector<Vec2> ratios;
    for (std::size_t i = 0; i < kFrontIntervals; ++i)
      if (r.seen.fronts[k][i].x() >= kComparedFrom)
        ratios.emplace_back(0, r.seen.fronts[k][i].y() / theory.fronts[k][i].y());
    r.front_errors[k] = rms_difference(ratios, [](double) { return 1.0; });
  }
  return r;
}

void judge(const std::vector<InclineResult>& results, const Spreading& theory,
           const MeasuredOutlines& measured, Report& report) {
  std::vector<Check> outlines, fronts, converges, theories;
  for (const InclineResult& r : results) {
    const std::string at = at_spacing(r.spacing);
    for (std::size_t k = 0; k < r.seen.outline_errors.size(); ++k)
      outlines.push_back(at_most(fmt::format("{}, t = {:.3g} s", at, measured.outlines[k].time),
                                 r.seen.outline_errors[k], kOutlineLimit));
    for (std::size_t k = 0; k < kFronts.size(); ++k)
      fronts.push_back(
          at_most(fmt::format("{}, {}", at, kFronts[k].name), r.front_errors[k], kInclineFrontLimit));
    if (&r != &results.front())
      converges.push_back(at_most(at, r.front_error() / results.front().front_error(), 1));
  }
  for (std::size_t k = 0; k < theory.outline_errors.size(); ++k)
    theories.push_back(at_most(fmt::format("t = {:.3g} s", measured.outlines[k].time),
                               theory.outline_errors[k], kTheoryLimit));
  const auto by_measurements = [&](Claim claim) {
    claim.source = fmt::format("{}, {}", measured.name, measured.figure);
    return claim;
  };
  report.statements = {judged(kFollowsTheory, fronts), judged(by_measurements(kTheoryIsRight), theories)};
  if (!outlines.empty())
    report.statements.insert(report.statements.begin(), judged(by_measurements(kIsWhereMeasured), outlines));
  if (!converges.empty()) report.statements.push_back(judged(kInclineConverges, converges));
}

/// Outlines of half of the plane, and the fronts in time.
std::vector<Plot> incline_plots(const std::vector<InclineResult>& results, const Spreading& theory,
                                const MeasuredOutlines& measured) {
  Plot outlines{"Outlines", "down the slope [m]", "across [m]", {}},
      fronts{"Fronts", "t [s]", "distance [m]", {}};
  for (const auto& outline : measured.outlines)
    outlines.curves.push_back(
        {fmt::format("{}, {:.3g} s", measured.name, outline.time), outline.points, Look::points});
  for (const InclineResult& r : results) {
    const std::string spacing = fmt::format("{:.3g} mm", 1000 * r.spacing);
    for (std::size_t k = 0; k < r.seen.outlines.size(); ++k)
      outlines.curves.push_back(
          {fmt::format("{}, {:.3g} s", spacing, measured.outlines[k].time), r.seen.outlines[k]});
    for (std::size_t k = 0; k < kFronts.size(); ++k)
      fronts.curves.push_back({fmt::format("{}, {}", kFronts[k].name, spacing), r.seen.fronts[k]});
  }
  for (const std::vector<Vec2>& outline : theory.outlines)
    outlines.curves.push_back(
        {&outline == &theory.outlines.front() ? "thin film" : "", outline, Look::reference});
  for (const std::vector<Vec2>& front : theory.fronts)
    fronts.curves.push_back({&front == &theory.fronts.front() ? "thin film" : "",
                             {front.begin(), front.begin() + kFrontIntervals},
                             Look::reference});
  return {outlines, fronts};
}

void write_spreading(const ExperimentContext& context, const std::vector<InclineResult>& results,
                     const Spreading& theory) {
  std::vector<std::vector<double>> rows, fronts;
  const auto add_fronts = [&](double spacing, const Spreading& seen) {
    for (std::size_t i = 0; i < seen.fronts[0].size(); ++i)
      fronts.push_back({spacing, seen.fronts[0][i].x(), seen.fronts[0][i].y(), seen.fronts[1][i].y(),
                        seen.fronts[2][i].y()});
  };
  add_fronts(0, theory);
  for (const InclineResult& r : results) {
    add_fronts(r.spacing, r.seen);
    const double outline_error = r.seen.outline_errors.empty() ? std::nan("") : r.seen.outline_errors.back();
    rows.push_back({r.spacing, static_cast<double>(r.particles), outline_error, theory.outline_errors.front(),
                    r.front_errors[0], r.front_errors[1], r.front_errors[2]});
  }
  write_file(context.folder / "fronts.csv", csv_text("spacing,time,down,across,up", fronts));
  write_file(context.folder / "summary.csv",
             csv_text("spacing,particles,outline_error,theory_outline_error,down_error,across_error,up_error",
                      rows));
}

}  // namespace

Report validate_incline(const ExperimentContext& context) {
  Scene scene = load_scene(context.file);
  const double duration = scene.duration;
  const MeasuredOutlines measured = measured_outlines(context);
  const bool quick = context.options.quick;
  if (quick) scene.duration *= kQuickDuration;
  const std::vector<double> whole{4.0 / 3, 1.0}, factors = quick ? std::vector{2.0} : whole;
  context.say("theory");
  const Spreading theory = run_film(scene, measured, quick ? 2 * kFilmCell : kFilmCell);
  std::vector<InclineResult> results;
  for (const double factor : factors) {
    const Scene refined = with_flow_rate(scene, factor * scene.fluid.spacing);
    context.say(at_spacing(refined.fluid.spacing));
    results.push_back(run_incline(refined, measured, theory));
  }

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format(
      "`{}`: silicone oil rises through a hole in a plane with a slope of {:.3g} degrees and spreads, {:.3g} "
      "s. "
      "The theory is that of thin films without surface tension, solved on cells of {:.3g} mm.",
      context.file.filename().string(),
      std::atan2(scene.fluid.gravity.x(), -scene.fluid.gravity.y()) * 180 / std::numbers::pi, scene.duration,
      1000 * (quick ? 2 * kFilmCell : kFilmCell));
  add_smaller(report, "spacing", spacings_text(scene, factors), spacings_text(scene, whole));
  add_smaller(report, "time", fmt::format("{:.3g} s", scene.duration), fmt::format("{:.3g} s", duration));
  judge(results, theory, measured, report);
  write_spreading(context, results, theory);
  add_plots(report, context, context.name, incline_plots(results, theory, measured),
            "Half of the outlines, and the fronts down the slope, across it and up.");
  report.files = {"summary.csv", "fronts.csv"};
  return report;
}

}  // namespace kappaflow
