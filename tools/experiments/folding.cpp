#include "tools/experiments/folding.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "solver/emitter.h"
#include "tools/experiments/falling_layers.h"
#include "tools/experiments/falling_regime.h"
#include "tools/experiments/slender_strip.h"
#include "tools/io/files.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

// The theory is that of a strip whose thickness is small against the height; here it is a tenth, and a layer
// of folds lies on the one before. Both change the frequency by a thickness over the height or so.
constexpr double kFrequencyLimit = 0.15;  // relative
constexpr double kPlaneLimit = 0.3;       // of the motion across the plane, over that in it

// What is claimed.

const Claim kFrequency{"Ribe 2003", "A strip folds as often as a slender strip does.",
                       "Relative difference of the mean angular frequency, for the mean height of the mouth "
                       "above the place where the strip comes to rest."};
const Claim kPlane{"kappaflow", "It folds to and fro and does not coil.",
                   "Root mean square of its place a third of the way down, across its plane over in it."};

// In the first the theory's frequency is 4.7 speeds over the height; without gravity it is 4.4 to 5.0,
// whatever viscosity and thickness are. In the second it depends on the height no more.
constexpr std::array kRegimes{FallingRegime{"viscous", 0.1, 1.0, 1.0, 2.7},
                              FallingRegime{"gravitational", 0.05, 9.81, 1.2, 2.2}};

/// Follows a strip: where it is a third of the way down, and where it comes to rest.
class FoldWatch {
 public:
  FoldWatch(const Emitter& emitter, std::size_t layer) : emitter_(emitter), layer_(layer) {}

  void look(const FluidSolver& liquid) {
    const FallingLayers layers(liquid, layer_);
    const double watched = kWatched * emitter_.position.y();
    const std::size_t rest =
        layers.first_slower(kAtRest * emitter_.speed, layers.first_below(watched, layers.count() - 1));
    if (rest == 0) return;
    const Vec3 place = layers.crossing(watched);
    sway_.emplace_back(liquid.time(), place.x());
    in_plane_ += std::pow(place.x(), 2);
    across_ += std::pow(place.z(), 2);
    rest_ += layers.center(rest).y();
  }

  const std::vector<Vec2>& sway() const { return sway_; }
  double height() const { return emitter_.position.y() - rest_ / static_cast<double>(sway_.size()); }
  double out_of_plane() const { return std::sqrt(across_ / in_plane_); }

  /// Angular, between the first and the last time that the strip passes its mean place [rad/s]; NaN if it
  /// does so less than twice.
  double frequency() const {
    double mean = 0;
    for (const Vec2& p : sway_) mean += p.y() / static_cast<double>(sway_.size());
    std::vector<double> passes;
    for (std::size_t k = 1; k < sway_.size(); ++k) {
      const double before = sway_[k - 1].y() - mean, after = sway_[k].y() - mean;
      if ((before < 0) == (after < 0)) continue;
      passes.push_back(std::lerp(sway_[k - 1].x(), sway_[k].x(), before / (before - after)));
    }
    if (passes.size() < 2) return std::nan("");
    return std::numbers::pi * static_cast<double>(passes.size() - 1) / (passes.back() - passes.front());
  }

 private:
  static constexpr double kWatched = 0.65;  // of the mouth's height: above the pile
  static constexpr double kAtRest = 0.1;    // of the mouth's speed

  Emitter emitter_;
  std::size_t layer_;
  std::vector<Vec2> sway_;  // (t, x a third of the way down)
  double in_plane_ = 0, across_ = 0, rest_ = 0;
};

struct FoldingResult {
  const FallingRegime* regime;
  double spacing;
  std::size_t particles;
  std::vector<Vec2> sway;
  double frequency, height, out_of_plane, theory;

  double error() const { return frequency / theory - 1; }
};

/// The theory for the particles that fit into the mouth.
double theory_of(const FallingRegime& regime, const Emitter& emitter, double spacing, double height) {
  const auto& mouth = std::get<RectangleMouth>(emitter.mouth);
  const std::size_t layer = emitter_layer(emitter, spacing).size();
  const double thickness = std::floor(mouth.height / spacing + 0.5) * spacing;
  const double width = static_cast<double>(layer) * spacing * spacing / thickness;
  return folding_frequency({regime.viscosity, regime.gravity, emitter.speed, thickness, width, height});
}

FoldingResult run_folding(const Scene& scene, const FallingRegime& regime) {
  const Emitter& emitter = scene.fluid.emitters.front();
  const double spacing = scene.fluid.spacing;
  FluidSolver liquid = make_liquid(scene);
  advance(liquid, regime.from);
  FoldWatch watch(emitter, emitter_layer(emitter, spacing).size());
  advance(liquid, regime.duration, [&](const FluidStep&) { watch.look(liquid); });
  return {&regime,
          spacing,
          liquid.size(),
          watch.sway(),
          watch.frequency(),
          watch.height(),
          watch.out_of_plane(),
          theory_of(regime, emitter, spacing, watch.height())};
}

void judge(const std::vector<FoldingResult>& results, Report& report) {
  std::vector<Check> frequency, plane;
  for (std::size_t k = 0; k < results.size(); ++k) {
    const FoldingResult& r = results[k];
    const std::string at = fmt::format("{}, spacing {:.3g} m", r.regime->name, r.spacing);
    frequency.push_back(at_most(at, std::abs(r.error()), kFrequencyLimit));
    plane.push_back(at_most(at, r.out_of_plane, kPlaneLimit));
  }
  report.statements = {judged(kFrequency, frequency), judged(kPlane, plane)};
  if (const auto checks = spacing_checks(results); !checks.empty())
    report.statements.push_back(judged(kConverges, checks));
}

std::vector<Plot> sway_plots(const std::vector<FoldingResult>& results) {
  std::vector<Plot> plots;
  for (const FoldingResult& r : results) {
    if (plots.empty() || plots.back().title != r.regime->name)
      plots.push_back({r.regime->name, "t [s]", "x a third of the way down [m]", {}});
    plots.back().curves.push_back({fmt::format("spacing {:.3g} mm", 1000 * r.spacing), r.sway});
  }
  return plots;
}

}  // namespace

Report validate_folding(const ExperimentContext& context) {
  const Scene scene = load_scene(context.file);
  const bool quick = context.options.quick;
  const std::vector<double> whole{4.0 / 3, 1.0}, factors = quick ? std::vector{4.0 / 3} : whole;
  const auto results = run_regimes(context, scene, kRegimes, factors, run_folding);
  std::vector<std::vector<double>> rows, sway;
  for (const FoldingResult& r : results) {
    rows.push_back({r.regime->viscosity, r.regime->gravity, r.spacing, static_cast<double>(r.particles),
                    r.height, r.frequency, r.theory, r.error(), r.out_of_plane});
    for (const Vec2& p : r.sway) sway.push_back({r.regime->viscosity, r.spacing, p.x(), p.y()});
  }
  write_file(context.folder / "sway.csv", csv_text("viscosity,spacing,time,x", sway));
  write_file(context.folder / "summary.csv",
             csv_text("viscosity,gravity,spacing,particles,height,frequency,theory_frequency,frequency_error,"
                      "out_of_plane",
                      rows));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format(
      "`{}`: a strip falls on a plate and folds, where its viscosity alone, and where its weight, bends it.",
      context.file.filename().string());
  add_smaller(report, "spacing", spacings_text(scene, factors), spacings_text(scene, whole));
  if (quick) add_smaller(report, "regimes", "1", "2");
  judge(results, report);
  add_plots(report, context, context.name, sway_plots(results),
            "Where the strip is a third of the way down: each sweep is a fold.");
  report.files = {"summary.csv", "sway.csv"};
  return report;
}

}  // namespace kappaflow
