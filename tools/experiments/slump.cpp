#include "tools/experiments/slump.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/experiments/validation.h"
#include "tools/io/files.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

// Of the slump over the height: a spacing, 1/15 of it. The relation takes layers to slide without friction.
constexpr double kSlumpLimit = 0.07;
constexpr double kCreepLimit = 0.005;  // of the height in the last quarter of the time, likewise

const Claim kSlumpsAsFar{"after Murata 1984; Pashias et al. 1996",
                         "The cylinder slumps as far as its yield stress lets it.",
                         "Difference of the slump over the height from s = 1 - y (1 - ln y), y = sqrt(3) "
                         "times the yield stress over rho g H."};
const Claim kStays{"kappaflow", "The heap stays.",
                   "Change of its height in the last quarter of the time, relative to the cylinder's."};

/// s over the height. The layer at the depth z under the top carries rho g z; it widens until it carries what
/// liquid that yields by the second invariant (von Mises) bears along one axis, sqrt(3) yield stresses, and
/// what is above z = sqrt(3) t H does not yield. Murata and Pashias et al. let it yield by the largest shear
/// stress (Tresca), with 2 in place of sqrt(3). The layers slide on each other and on the plate without
/// friction.
double known_slump(double t) {
  const double y = std::numbers::sqrt3 * t;
  return 1 - y * (1 - std::log(y));
}

/// Of the highest particle within two spacings of the axis, and half a spacing.
double height_at_axis(const FluidSolver& liquid, double spacing) {
  double top = 0;
  for (const Vec3& x : liquid.particles().position)
    if (std::hypot(x.x(), x.z()) < 2 * spacing) top = std::max(top, x.y());
  return top + spacing / 2;
}

struct SlumpResult {
  double yield;  ///< stress over rho g H
  std::size_t particles;
  std::vector<Vec2> heights;  ///< (time [s], height over H)
  double slump, creep;
  double worst_viscosity;  ///< error of the viscous solves over what is tolerated
};

SlumpResult run_slump(const Scene& scene, double yield) {
  FluidSolver liquid = make_liquid(scene);
  const double height = std::get<MeshShape>(scene.blocks.front().shape).scale;
  SlumpResult r{yield, liquid.size(), {}, 0, 0, 0};
  constexpr int kTimes = 40;
  for (int k = 1; k <= kTimes; ++k) {
    advance(liquid, scene.duration * k / kTimes, [&](const FluidStep& step) {
      r.worst_viscosity = std::max(r.worst_viscosity, step.viscosity_error);
    });
    r.heights.emplace_back(liquid.time(), height_at_axis(liquid, scene.fluid.spacing) / height);
  }
  r.slump = 1 - r.heights.back().y();
  r.creep = r.heights[kTimes * 3 / 4 - 1].y() - r.heights.back().y();
  return r;
}

Scene with_yield(Scene scene, double yield) {
  auto& law = std::get<HerschelBulkley>(scene.fluid.rheologies.front());
  law.yield_stress =
      yield * scene.fluid.gravity.norm() * std::get<MeshShape>(scene.blocks.front().shape).scale;
  return scene;
}

void judge(const std::vector<SlumpResult>& results, Report& report) {
  std::vector<Check> slumps, creeps;
  for (const SlumpResult& r : results) {
    const std::string at = fmt::format("yield stress {:.3g} rho g H", r.yield);
    slumps.push_back(at_most(at, std::abs(r.slump - known_slump(r.yield)), kSlumpLimit));
    creeps.push_back(at_most(at, std::abs(r.creep), kCreepLimit));
  }
  report.statements = {judged(kSlumpsAsFar, slumps), judged(kStays, creeps)};
}

}  // namespace

Report validate_slump(const ExperimentContext& context) {
  const Scene whole = load_scene(context.file);
  const std::vector<double> yields =
      context.options.quick ? std::vector{0.15} : std::vector{0.1, 0.15, 0.2, 0.3};
  const Scene scene = with_spacing(whole, (context.options.quick ? 1.5 : 1.0) * whole.fluid.spacing);
  std::vector<SlumpResult> results;
  std::vector<std::vector<double>> rows, heights;
  Plot plot{"Height at the axis", "t [s]", "height / H", {}};
  for (const double yield : yields) {
    context.say(fmt::format("yield stress {:.3g} rho g H", yield));
    results.push_back(run_slump(with_yield(scene, yield), yield));
    const SlumpResult& r = results.back();
    plot.curves.push_back({fmt::format("yield stress {:.3g} rho g H", yield), r.heights});
    plot.curves.push_back(
        {"", {{0, 1 - known_slump(yield)}, {scene.duration, 1 - known_slump(yield)}}, Look::reference});
    rows.push_back(
        {yield, static_cast<double>(r.particles), known_slump(yield), r.slump, r.creep, r.worst_viscosity});
    for (const Vec2& p : r.heights) heights.push_back({yield, p.x(), p.y()});
  }
  write_file(context.folder / "heights.csv", csv_text("yield_stress,time,height", heights));
  write_file(context.folder / "summary.csv",
             csv_text("yield_stress,particles,known_slump,slump,creep,viscosity_error", rows));

  Report report;
  report.name = context.name;
  report.title = scene.title;
  report.introduction = fmt::format(
      "`{}`: a cylinder of the height H and as wide, let go on a plate without slip; {:.3g} s at a spacing "
      "of "
      "{:.3g} m.",
      context.file.filename().string(), scene.duration, scene.fluid.spacing);
  add_smaller(report, "spacing", spacings_text(scene, std::vector{1.0}),
              spacings_text(whole, std::vector{1.0}));
  judge(results, report);
  add_plots(report, context, context.name, std::vector{plot}, "Heights, and the final ones of the relation.");
  report.files = {"summary.csv", "heights.csv"};
  return report;
}

}  // namespace kappaflow
