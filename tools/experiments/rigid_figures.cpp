#include "tools/experiments/rigid_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/experiments/peers.h"
#include "tools/experiments/rigid_chapter.h"
#include "tools/pictures/method_curve.h"

namespace kappaflow {
namespace {

// Limits; errors are in body sizes.
constexpr double kDistorted = 10;  // largest over smallest area ratio of triangles: more is a distorted mesh
constexpr double kUndistorted = 1.001;  // less is none: rounding and the projection's tolerance
constexpr double kHalf = 0.5;           // of total's error: what counts as clearly better
constexpr double kVisible = 0.02;       // what shows in a picture of the mesh
constexpr double kAccurate = 1e-4;      // RK4 on a sphere, which is smooth in time
constexpr double kRounding = 1e-9;      // that thirty turns may add up to

// What is claimed.

const Claim kTranslationKeepsTheMesh{
    "Fujisawa et al. 2011, Fig. 3",
    "Under a translation the normal velocity alone distorts the mesh; total and curvature keep it.",
    "Largest over smallest ratio of a triangle's area to that at rest. A translation changes no normal and "
    "no curvature, so both methods find it; the normal velocity leaves "
    "the "
    "vertices behind, and they gather at the back."};

const Claim kCurvatureSeesRotation{
    "Fujisawa et al. 2011, section 4",
    "Curvature invariance follows a rotation that total velocity does not see.",
    "Mean distance to the true trajectory over the whole run. The curvature rows are exact under rotation; "
    "in Eq. 10 "
    "the rows of total velocity pull their solution away. Without the rows of total the parts of the surface "
    "that "
    "one particle alone makes are left to the damping."};

Claim total_is_visibly_off(int turns) {
  return {"Fujisawa et al. 2011, Figs. 6 and 7",
          fmt::format("After {} turns the mesh of total velocity is visibly off, that of curvature is not.",
                      turns),
          "Mean distance to the start [body size]. On a sphere K and H are constant: the curvature rows of "
          "Eq. 10 are empty and both methods are one "
          "and the "
          "same. What shows is the integrator's error."};
}

const Claim kOneMethodOnASphere{
    "kappaflow", "On a sphere Eq. 10 is total velocity.",
    "Difference of the errors after all turns [body size]: rounding. K and H are constant, and their rows "
    "are "
    "empty. Where the paper's statements on Fig. 8 hold, over what it leaves open: `paper-map`."};

Claim rk4_is_accurate(const RigidExperiment& experiment) {
  return {"kappaflow",
          fmt::format("With RK4 the error after {} turns of {} steps is at most 1e-4.", experiment.cycles,
                      experiment.steps_per_cycle),
          "Mean distance to the start [body size]. The spin of a sphere is smooth in time."};
}

/// The triangles at the end of a translation.
void judge_translation(Chapter& chapter) {
  const auto of = [&](const char* method) -> const RigidSample& {
    return find_case(chapter.cases, "one", method, chapter.experiment.integrators.front(), 0).samples.back();
  };
  const auto spread = [](const RigidSample& s) {
    return s.distortion.area_ratio_max / s.distortion.area_ratio_min;
  };
  const RigidSample &start = chapter.cases.front().samples.front(), &normal = of("normal"),
                    &total = of("total"), &curvature = of("curvature");
  chapter.report.statements.push_back(
      judged(kTranslationKeepsTheMesh, {at_least("normal distorts", spread(normal), kDistorted),
                                        at_most("total keeps", spread(total), kUndistorted),
                                        at_most("curvature keeps", spread(curvature), kUndistorted)}));
  const auto aspect = [](const RigidSample& s) {
    return fmt::format("largest aspect ratio {:.3g}", s.distortion.aspect_max);
  };
  chapter.report.beside =
      beside_paper("Fig. 3", {{"motion", "one particle from left to right", "the same"},
                              {"radius, threshold, steps", "not stated", "see above"},
                              {"mesh at the start", "", aspect(start)},
                              {"with the normal velocity", "distorted", aspect(normal)},
                              {"with total velocity", "kept", aspect(total)},
                              {"with curvature invariance (Eq. 10)", "kept", aspect(curvature)}});
}

void judge_thirty_turns(Chapter& chapter) {
  const TimeIntegrator first = chapter.experiment.integrators.front();
  const std::string with = fmt::format(" with {}", name_of(kIntegrators, first));
  const double total = end_error(chapter, find_case(chapter.cases, "one", "total", first, 0)),
               curvature = end_error(chapter, find_case(chapter.cases, "one", "curvature", first, 0));
  chapter.report.statements.push_back(
      judged(total_is_visibly_off(chapter.experiment.cycles),
             {at_least("total is off" + with, total, kVisible),
              at_most("curvature is not" + with, curvature, kHalf * total, "half of total's")}));
  chapter.report.beside =
      beside_paper("Figs. 6 and 7", {{"motion", "one particle, 30 turns, no fairing",
                                      fmt::format("the same, {} turns", chapter.experiment.cycles)},
                                     {"radius, threshold, steps, integrator", "not stated", "see above"},
                                     {"mesh of total velocity", "visibly off",
                                      fmt::format("off by {:.2g} of the body's size{}", total, with)},
                                     {"mesh of curvature invariance (Eq. 10)", "not off",
                                      fmt::format("off by {:.2g}{}", curvature, with)}});
}

/// The error after all turns with each integrator: "euler 0.18, rk4 2e-12".
std::string end_errors(const Chapter& chapter, const char* method) {
  std::vector<std::string> errors;
  errors.reserve(chapter.experiment.integrators.size());
  for (const TimeIntegrator integrator : chapter.experiment.integrators)
    errors.push_back(fmt::format("{:.2g} ({})",
                                 end_error(chapter, find_case(chapter.cases, "one", method, integrator, 0)),
                                 name_of(kIntegrators, integrator)));
  return fmt::format("{}", fmt::join(errors, ", "));
}

/// The error after each turn, with each integrator.
void judge_integrators(const PaperFigures& paper, Chapter& chapter) {
  std::vector<Check> same, accurate;
  for (const TimeIntegrator integrator : chapter.experiment.integrators) {
    const double total = end_error(chapter, find_case(chapter.cases, "one", "total", integrator, 0)),
                 curvature = end_error(chapter, find_case(chapter.cases, "one", "curvature", integrator, 0));
    same.push_back(
        at_most(std::string(name_of(kIntegrators, integrator)), std::abs(total - curvature), kRounding));
    if (integrator == TimeIntegrator::rk4)
      accurate = {at_most("total", total, kAccurate), at_most("curvature", curvature, kAccurate)};
  }
  auto& statements = chapter.report.statements;
  statements.push_back(judged(kOneMethodOnASphere, same));
  if (!accurate.empty()) statements.push_back(judged(rk4_is_accurate(chapter.experiment), accurate));
  chapter.report.beside = beside_paper(
      "Fig. 8", {{"motion", "one particle, 30 turns, no fairing",
                  fmt::format("the same, {} turns", chapter.experiment.cycles)},
                 {"error of total velocity at the end",
                  fmt::format("about {}, linear in the turns", paper.total_after_30_turns),
                  end_errors(chapter, "total")},
                 {"of curvature invariance (Eq. 10)", "hardly grows", end_errors(chapter, "curvature")}});
}

/// The error after each turn, a plot an integrator.
std::vector<Plot> plots_of_integrators(const Chapter& chapter) {
  std::vector<Plot> plots;
  for (const TimeIntegrator integrator : chapter.experiment.integrators) {
    Plot plot{
        std::string(name_of(kIntegrators, integrator)), "turns", "error after turns [body size]", {}, true};
    for (const char* method : {"total", "curvature"}) {
      const RigidCase& c = find_case(chapter.cases, "one", method, integrator, 0);
      Curve curve = method_curve(c.method);
      for (int turn = 1; turn <= chapter.experiment.cycles; ++turn)
        curve.points.emplace_back(turn, c.end_error(turn, chapter.experiment.steps_per_cycle));
      plot.curves.push_back(std::move(curve));
    }
    plots.push_back(std::move(plot));
  }
  return plots;
}

Statement judge_body(const Chapter& chapter) {
  const auto mean = [&](const char* method) {
    return find_case(chapter.cases, "seven", method, chapter.experiment.integrators.front(), 0)
        .mean_over_run();
  };
  const double limit = kHalf * mean("total");
  return judged(kCurvatureSeesRotation,
                {at_most("the sum of Eq. 10", mean("curvature"), limit, "half of total's"),
                 at_most("its curvature rows alone", mean("curvature-only"), limit, "half of total's")});
}

std::vector<const RigidCase*> all_cases(const Chapter& chapter) {
  return select(chapter.cases, [](const RigidCase&) { return true; });
}

}  // namespace

Report experiment_fig3(const ExperimentContext& context) {
  Chapter chapter =
      run_chapter(context,
                  "A sphere is moved in a straight line. Each method has the same normal velocity; what it "
                  "adds along the surface decides what becomes of the triangles.");
  judge_translation(chapter);
  const std::vector<const RigidCase*> all = all_cases(chapter);
  add_mesh_figure(chapter, context, "fig3", all, "The mesh at the start and at the end of the way.");
  add_plots(chapter.report, context, "fig3-aspect",
            std::vector{plot_over_time("Triangles on the way", "share of the way", "largest aspect ratio",
                                       all, 0, [](const RigidSample& s) { return s.distortion.aspect_max; })},
            "The largest aspect ratio of a triangle on the way.");
  chapter.report.tables.push_back(case_table(chapter));
  return chapter.report;
}

Report experiment_fig7(const ExperimentContext& context) {
  Chapter chapter = run_chapter(
      context,
      "One particle turns on a circle; its surface is a sphere. Without fairing, all that can move the mesh "
      "off is the integration in time. (A sphere does not show its own spin, so over the run every method "
      "stays up to a diameter away from a body that spins with the turn; after whole turns the two agree.)");
  for (const TimeIntegrator integrator : chapter.experiment.integrators) {
    const std::string name = fmt::format("fig7-{}", name_of(kIntegrators, integrator));
    add_mesh_figure(chapter, context, name,
                    select(chapter.cases, [&](const RigidCase& c) { return c.integrator == integrator; }),
                    fmt::format("Integrated with {}: after whole turns the mesh should be where it started.",
                                name_of(kIntegrators, integrator)));
  }
  judge_thirty_turns(chapter);
  chapter.report.tables.push_back(case_table(chapter));
  return chapter.report;
}

Report experiment_fig8(const ExperimentContext& context) {
  Chapter chapter =
      run_chapter(context, "The particle of fig7, with each integrator: the error after each turn.");
  judge_integrators(paper_figures(context), chapter);
  add_plots(chapter.report, context, "fig8", plots_of_integrators(chapter), "Error after each turn.");
  chapter.report.tables.push_back(case_table(chapter));
  return chapter.report;
}

Report experiment_body(const ExperimentContext& context) {
  Chapter chapter = run_chapter(context,
                                "Seven particles of unequal size and weight: curvature varies all over the "
                                "surface, so that curvature invariance knows the motion almost everywhere.");
  chapter.report.statements.push_back(judge_body(chapter));
  const std::vector<const RigidCase*> all = all_cases(chapter);
  chapter.report.statements.push_back(regional_follows(chapter));
  add_mesh_figure(chapter, context, "body", all, "The body of seven particles.");
  add_plots(chapter.report, context, "body-errors",
            std::vector{error_over_turns("Seven unequal particles", all)},
            "Mean distance of the vertices to where the rigid motion takes them.");
  chapter.report.tables.push_back(case_table(chapter));
  return chapter.report;
}

}  // namespace kappaflow
