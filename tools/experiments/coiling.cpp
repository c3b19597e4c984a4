#include "tools/experiments/coiling.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "solver/emitter.h"
#include "tools/experiments/falling_layers.h"
#include "tools/experiments/falling_regime.h"
#include "tools/experiments/slender_thread.h"
#include "tools/io/files.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

// The theory is that of a thread whose radius is small against the coil's; here it is 0.4 times that, and the
// coil grows under the thread, soft as it is. Besides, the thread turns unevenly, by 0.1 turns of 2 to 3.
constexpr double kFrequencyLimit = 0.15;  // relative
constexpr double kThreadLimit = 0.1;      // of the thread in the coil, relative

// What is claimed.

const Claim kFrequency{
    "Ribe 2004", "A thread coils as often as a slender thread does.",
    "Relative difference of the mean angular frequency, whichever way it turns, for the mean height of the "
    "mouth above the place where the thread comes to rest; at the finest spacing."};
const Claim kThreadRadius{"Ribe 2004", "It is as thick in the coil.",
                          "Relative difference of the radius, from the distances of the layers laid down."};

// In the first the frequency goes with the height to the power -0.8, in the second with its power 0.1: those
// of the theory for viscous and for gravitational coiling are -1 and 0. The first turn and a half, on the
// bare plate, are wider than the others, and a thread under its weight may fold before it coils.
constexpr std::array kRegimes{FallingRegime{"viscous", 0.1, 1.0, 1.6, 3.4},
                              FallingRegime{"gravitational", 0.05, 9.81, 1.8, 4.0}};

struct CoilingResult {
  const FallingRegime* regime;
  double spacing;
  std::size_t particles;
  std::vector<Vec2> turned;  ///< (t, turns since the regime's `from`, whichever way)
  double frequency, height, thread_radius;
  SteadyCoil theory;

  double frequency_error() const { return std::abs(frequency / theory.frequency - 1); }
  double radius_error() const { return std::abs(thread_radius / theory.thread_radius - 1); }
};

/// Follows a thread: how far it has turned about the axis, where it comes to rest, how far apart its layers
/// then are.
class CoilWatch {
 public:
  CoilWatch(const Scene& scene, std::size_t layer) : emitter_(scene.fluid.emitters.front()), layer_(layer) {}

  void look(const FluidSolver& liquid) {
    const FallingLayers layers(liquid, layer_);
    const std::size_t middle = layers.first_below(kMiddle * emitter_.position.y(), layers.count() - 1);
    const std::size_t k = layers.first_slower(kAtRest * emitter_.speed, middle);
    if (k < kLaid) return;
    const Vec3 axis = layers.center(middle);
    const double angle = std::atan2(axis.z(), axis.x());
    if (!turned_.empty()) angle_ += std::abs(std::remainder(angle - last_, 2 * std::numbers::pi));
    last_ = angle;
    turned_.emplace_back(liquid.time(), angle_ / (2 * std::numbers::pi));
    rest_ += layers.center(k).y();
    for (std::size_t laid = k - kLaid; laid < k; ++laid)
      gap_ += (layers.center(laid + 1) - layers.center(laid)).norm() / kLaid;
  }

  const std::vector<Vec2>& turned() const { return turned_; }
  double frequency() const { return angle_ / (turned_.back().x() - turned_.front().x()); }
  double height() const { return emitter_.position.y() - rest_ / static_cast<double>(turned_.size()); }
  double gap() const { return gap_ / static_cast<double>(turned_.size()); }

 private:
  static constexpr std::size_t kLaid = 10;  // layers
  static constexpr double kMiddle = 0.45;   // of the mouth's height
  static constexpr double kAtRest = 0.1;    // of the mouth's speed

  Emitter emitter_;
  std::size_t layer_;
  std::vector<Vec2> turned_;
  double angle_ = 0;  // whichever way: a thread that something disturbs may turn round, and coils on as fast
  double last_ = 0, rest_ = 0, gap_ = 0;
};

CoilingResult run_coiling(const Scene& scene, const FallingRegime& regime) {
  const Emitter& emitter = scene.fluid.emitters.front();
  const double spacing = scene.fluid.spacing;
  const std::size_t layer = emitter_layer(emitter, spacing).size();
  FluidSolver liquid = make_liquid(scene);
  advance(liquid, regime.from);
  CoilWatch watch(scene, layer);
  advance(liquid, regime.duration, [&](const FluidStep&) { watch.look(liquid); });
  const double section = static_cast<double>(layer) * spacing * spacing;
  const double mouth_radius = std::sqrt(section / std::numbers::pi);
  const FallingThread thread{regime.viscosity, regime.gravity, emitter.speed, mouth_radius, watch.height()};
  return {&regime,
          spacing,
          liquid.size(),
          watch.turned(),
          watch.frequency(),
          watch.height(),
          mouth_radius * std::sqrt(spacing / watch.gap()),
          steady_coil(thread)};
}

void judge(const std::vector<CoilingResult>& results, Report& report) {
  std::vector<Check> frequency, radius;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const CoilingResult& r = results[k];
    const std::string at = fmt::format("{}, spacing {:.3g} m", r.regime->name, r.spacing);
    const bool finest = k + 1 == results.size() || results[k + 1].regime != r.regime;
    if (finest) frequency.push_back(at_most(at, r.frequency_error(), kFrequencyLimit));
    radius.push_back(at_most(at, r.radius_error(), kThreadLimit));
  }
  report.statements = {judged(kFrequency, frequency), judged(kThreadRadius, radius)};
  if (const auto checks = spacing_checks(results); !checks.empty())
    report.statements.push_back(judged(kConverges, checks));
}

std::vector<Plot> turn_plots(const std::vector<CoilingResult>& results) {
  std::vector<Plot> plots;
  for (const CoilingResult& r : results) {
    if (plots.empty() || plots.back().title != r.regime->name)
      plots.push_back({r.regime->name, "t [s]", "turns", {}});
    plots.back().curves.push_back({fmt::format("spacing {:.3g} mm", 1000 * r.spacing), r.turned});
    if (&r != &results.back() && (&r)[1].regime == r.regime) continue;
    const double first = r.turned.front().x(), last = r.turned.back().x();
    plots.back().curves.push_back(
        {"slender thread",
         {{first, 0}, {last, r.theory.frequency * (last - first) / (2 * std::numbers::pi)}},
         Look::reference});
  }
  return plots;
}

}  // namespace

Report validate_coiling(const ExperimentContext& context) {
  const Scene scene = load_scene(context.file);
  const bool quick = context.options.quick;
  const std::vector<double> whole{4.0 / 3, 1.0}, factors = quick ? std::vector{1.6} : whole;
  const auto results = run_regimes(context, scene, kRegimes, factors, run_coiling);
  std::vector<std::vector<double>> rows, turns;
  for (const CoilingResult& r : results) {
    rows.push_back({r.regime->viscosity, r.regime->gravity, r.spacing, static_cast<double>(r.particles),
                    r.height, r.frequency, r.theory.frequency, r.frequency / r.theory.frequency - 1,
                    r.thread_radius, r.theory.thread_radius, r.theory.radius});
    for (const Vec2& p : r.turned) turns.push_back({r.regime->viscosity, r.spacing, p.x(), p.y()});
  }
  write_file(context.folder / "turns.csv", csv_text("viscosity,spacing,time,turns", turns));
  write_file(context.folder / "summary.csv",
             csv_text("viscosity,gravity,spacing,particles,height,frequency,theory_frequency,frequency_error,"
                      "thread_radius,theory_thread_radius,theory_coil_radius",
                      rows));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format(
      "`{}`: a thread falls on a plate and coils, where its viscosity alone, and where its weight, bends it. "
      "The "
      "coil grows under the thread, so the height is the mean one over the time that is shown.",
      context.file.filename().string());
  add_smaller(report, "spacing", spacings_text(scene, factors), spacings_text(scene, whole));
  if (quick) add_smaller(report, "regimes", "1", "2");
  judge(results, report);
  add_plots(report, context, context.name, turn_plots(results),
            "How often the thread has turned, and a slender thread would have.");
  report.files = {"summary.csv", "turns.csv"};
  return report;
}

}  // namespace kappaflow
