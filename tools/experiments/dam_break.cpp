#include "tools/experiments/dam_break.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tools/experiments/peers.h"
#include "tools/experiments/validation.h"
#include "tools/io/files.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

// The measurements scatter by about 0.1 (the two columns of the figure differ by that), and a front is known
// to about a spacing, 0.05 a. All limits are RMS of Z over the measurements, relative to the RMS of Z.
constexpr double kLimit = 0.05;           // with the time of release that fits best
constexpr double kFrontSpeedLimit = 0.1;  // of the mean speed
constexpr double kGridLimit = 0.03;       // between the two spacings
constexpr double kDelayLimit = 0.35;      // of the release [a measurement's T]: less than between two of them

constexpr double kSpeedFrom =
    1.9;  // [T] the mean speed is that from the first measurement after it to the last

// What is claimed. The source of the first three is that of the measurements.

const Claim kFrontIsThere{
    "", "The front is where it was measured.",
    "RMS over the seven measurements up to T = 4.4, relative to the RMS of Z, for a column let "
    "go when it fits best."};
const Claim kFrontWasLetGo{
    "", "It was let go within the uncertainty of that instant.",
    "The same delay in T fits all measurements: what it would be for a column that a membrane "
    "keeps back for a moment."};
const Claim kFrontIsAsFast{
    "", "The front is as fast as it was measured.",
    "Mean speed from T = 2.0 to 4.4, relative to the measured one: it does not depend on when the "
    "column was let go."};
const Claim kFrontIsResolved{"kappaflow", "The front hardly depends on the spacing.",
                             "Between the two spacings, at the same times."};

/// Mean over slices one spacing thick of the place of the foremost particle, and half a spacing.
double column_front(const FluidSolver& liquid, const Scene& scene) {
  const double h = scene.fluid.spacing;
  std::vector<double> foremost;
  for (const Vec3& x : liquid.particles().position) {
    const auto slice = static_cast<std::size_t>(std::max(x.z() / h, 0.0));
    if (slice >= foremost.size()) foremost.resize(slice + 1, 0);
    foremost[slice] = std::max(foremost[slice], x.x());
  }
  double sum = 0;
  for (const double x : foremost) sum += x;
  return sum / static_cast<double>(foremost.size()) + h / 2;
}

struct DamBreakResult {
  double spacing;
  std::size_t particles;
  std::vector<Vec2> fronts;  ///< (T, Z) of every step
};

DamBreakResult run_dam_break(const Scene& scene) {
  const auto& column = std::get<BoxShape>(scene.blocks.front().shape);
  const double a = column.upper.x() - column.lower.x();
  const double unit = std::sqrt(2 * scene.fluid.gravity.norm() / a);
  FluidSolver liquid = make_liquid(scene);
  DamBreakResult r{scene.fluid.spacing, liquid.size(), {{0, 1}}};
  advance(liquid, scene.duration, [&](const FluidStep&) {
    r.fronts.emplace_back(unit * liquid.time(), column_front(liquid, scene) / a);
  });
  return r;
}

/// The same fronts of a column let go at T = delay.
std::vector<Vec2> later(std::vector<Vec2> fronts, double delay) {
  for (Vec2& front : fronts) front.x() += delay;
  return fronts;
}

/// Linear between the steps.
double front_at(const DamBreakResult& r, double time) {
  const auto next = std::ranges::find_if(r.fronts, [=](const Vec2& p) { return p.x() >= time; });
  if (next == r.fronts.begin() || next == r.fronts.end()) return std::nan("");
  const Vec2 &a = *(next - 1), &b = *next;
  return a.y() + (b.y() - a.y()) * (time - a.x()) / (b.x() - a.x());
}

/// Of a column let go at T = delay.
double relative_error(const DamBreakResult& r, std::span<const Vec2> measured, double delay) {
  return rms_difference(measured, [&](double time) { return front_at(r, time - delay); }) /
         rms_difference(measured, [](double) { return 0.0; });
}

/// The delay for which the error is smallest, to 0.01.
double best_delay(const DamBreakResult& r, std::span<const Vec2> measured) {
  double best = 0;
  for (int k = 0; k < 60; ++k)
    if (relative_error(r, measured, 0.01 * k) < relative_error(r, measured, best)) best = 0.01 * k;
  return best;
}

/// Mean speed of the front between two measurements dZ/dT.
double speed(const Vec2& from, const Vec2& to) {
  return (to.y() - from.y()) / (to.x() - from.x());
}

/// Relative to the measured one, from T = kSpeedFrom on.
double speed_error(const DamBreakResult& r, std::span<const Vec2> measured) {
  const Vec2 &from = *std::ranges::find_if(measured.first(measured.size() - 1),
                                           [](const Vec2&p) { return p.x() >= kSpeedFrom; }),
             &to = measured.back();
  return std::abs(speed({from.x(), front_at(r, from.x())}, {to.x(), front_at(r, to.x())}) / speed(from, to) -
                  1);
}

/// One spacing against the measurements.
struct FrontErrors {
  double at_once;      ///< of a column let go at T = 0
  double delay, best;  ///< for which the error is smallest, and that error
  double speed;
};

FrontErrors front_errors(const DamBreakResult& r, std::span<const Vec2> measured) {
  const double delay = best_delay(r, measured);
  return {relative_error(r, measured, 0), delay, relative_error(r, measured, delay),
          speed_error(r, measured)};
}

/// Between two spacings, at the times of the measurements.
double grid_difference(const DamBreakResult& coarse, const DamBreakResult& fine,
                       std::span<const Vec2> measured) {
  std::vector<Vec2> fronts;
  for (const Vec2& p : measured) fronts.emplace_back(p.x(), front_at(fine, p.x()));
  return rms_difference(fronts, [&](double time) { return front_at(coarse, time); }) /
         rms_difference(fronts, [](double) { return 0.0; });
}

void judge(const std::vector<DamBreakResult>& results, const MeasuredFronts& measured, Report& report) {
  std::vector<Check> errors, delays, speeds;
  for (const DamBreakResult& r : results) {
    const std::string at = fmt::format("spacing {:.3g} m", r.spacing);
    const FrontErrors e = front_errors(r, measured.points);
    errors.push_back(at_most(at, e.best, kLimit));
    delays.push_back(at_most(at, e.delay, kDelayLimit));
    speeds.push_back(at_most(at, e.speed, kFrontSpeedLimit));
  }
  const auto by_measurements = [&](Claim claim) {
    claim.source = fmt::format("{}, {}", measured.name, measured.figure);
    return claim;
  };
  report.statements = {judged(by_measurements(kFrontIsThere), errors),
                       judged(by_measurements(kFrontWasLetGo), delays),
                       judged(by_measurements(kFrontIsAsFast), speeds)};
  if (results.size() < 2) return;
  const double difference = grid_difference(results.front(), results.back(), measured.points);
  report.statements.push_back(judged(kFrontIsResolved, {at_most("", difference, kGridLimit)}));
}

/// Let go when each fits best, and at T = 0.
std::vector<Plot> front_plots(const std::vector<DamBreakResult>& results, const MeasuredFronts& measured) {
  const Plot axes{"", "t sqrt(2 g / a)", "front / a", {{measured.name, measured.points, Look::points}}};
  std::vector<Plot> plots(2, axes);
  plots[0].title = "let go when it fits best";
  plots[1].title = "let go at T = 0";
  for (const DamBreakResult& r : results) {
    const double delay = front_errors(r, measured.points).delay;
    plots[0].curves.push_back(
        {fmt::format("{:.3g} mm, T = {:.2f}", 1000 * r.spacing, delay), later(r.fronts, delay)});
    plots[1].curves.push_back({fmt::format("{:.3g} mm", 1000 * r.spacing), r.fronts});
  }
  return plots;
}

void write_fronts(const ExperimentContext& context, const std::vector<DamBreakResult>& results,
                  const MeasuredFronts& measured) {
  std::vector<std::vector<double>> rows, fronts;
  for (const DamBreakResult& r : results) {
    const FrontErrors e = front_errors(r, measured.points);
    rows.push_back({r.spacing, static_cast<double>(r.particles), e.at_once, e.delay, e.best, e.speed});
    for (const Vec2& p : r.fronts) fronts.push_back({r.spacing, p.x(), p.y()});
  }
  write_file(context.folder / "fronts.csv", csv_text("spacing,time,front", fronts));
  write_file(context.folder / "summary.csv",
             csv_text("spacing,particles,front_error,delay,delayed_front_error,speed_error", rows));
}

}  // namespace

Report validate_dam_break(const ExperimentContext& context) {
  const Scene scene = load_scene(context.file);
  const MeasuredFronts measured = measured_fronts(context);
  const std::vector<double> whole{1.0, 2.0 / 3}, factors = context.options.quick ? std::vector{2.0} : whole;
  std::vector<DamBreakResult> results;
  for (const double factor : factors) {
    const Scene refined = with_spacing(scene, factor * scene.fluid.spacing);
    context.say(fmt::format("spacing {:.3g} m", refined.fluid.spacing));
    results.push_back(run_dam_break(refined));
  }

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format(
      "`{}`: a column of water of length a = 2.25 inches and height 2 a between two walls, let go at t = 0. "
      "The front is the foremost particle of each slice one spacing thick, in the mean, and half a spacing.",
      context.file.filename().string());
  add_smaller(report, "spacing", spacings_text(scene, factors), spacings_text(scene, whole));
  judge(results, measured, report);
  write_fronts(context, results, measured);
  add_plots(
      report, context, context.name, front_plots(results, measured),
      "The measured front, and the computed one, let go at the time for which the two fit best (what the "
      "verdict is about) and at T = 0.");
  report.files = {"summary.csv", "fronts.csv"};
  return report;
}

}  // namespace kappaflow
