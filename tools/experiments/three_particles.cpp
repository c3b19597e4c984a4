// Figs. 4 and 5: three particles that turn, with fairing.
#include <fmt/format.h>

#include <algorithm>

#include "tools/experiments/peers.h"
#include "tools/experiments/rigid_chapter.h"
#include "tools/experiments/rigid_figures.h"
#include "tools/pictures/method_curve.h"

namespace kappaflow {
namespace {

constexpr double kClearlyBetter = 0.5;  // of total's error

// What is claimed.

const Claim kCurvatureFollowsBetter{
    "kappaflow",
    "Over the whole run, curvature's distance to the true trajectory is less than half of total's.",
    "Mean distance [body size]. Under rotation the rows of total velocity contradict those of curvature "
    "invariance, and Eq. 10 adds "
    "them up: "
    "its solution lies between the two. Where one particle alone makes the surface, K and H are constant and "
    "say "
    "nothing."};

/// A body tracked with a number of fairing iterations: errors of the two methods.
struct TotalAndCurvature {
  std::string where;
  bool faired;
  double total_end, curvature_end;    ///< after whole turns
  double total_mean, curvature_mean;  ///< over the whole run
};

std::vector<TotalAndCurvature> total_and_curvature(const Chapter& chapter) {
  std::vector<TotalAndCurvature> errors;
  for (const TrackedBody& body : chapter.experiment.bodies)
    for (const int fairing : chapter.experiment.fairing_iterations) {
      const auto of = [&](const char* method) -> const RigidCase& {
        return find_case(chapter.cases, body.name, method, chapter.experiment.integrators.front(), fairing);
      };
      const RigidCase &total = of("total"), &curvature = of("curvature");
      errors.push_back({fmt::format("{} with {} iterations", body.name, fairing), fairing > 0,
                        end_error(chapter, total), end_error(chapter, curvature), total.mean_over_run(),
                        curvature.mean_over_run()});
    }
  return errors;
}

/// "0.2 to 0.4": the least and the greatest.
std::string range_text(const std::vector<double>& numbers) {
  if (numbers.empty()) return "-";
  const auto [low, high] = std::ranges::minmax(numbers);
  return low == high ? fmt::format("{:.2g}", low) : fmt::format("{:.2g} to {:.2g}", low, high);
}

/// Figs. 4 and 5.
Table beside_three_particles(const PaperFigures& paper, const Chapter& chapter) {
  std::vector<double> total, curvature, curvature_run, total_run;
  for (const TotalAndCurvature& e : total_and_curvature(chapter)) {
    if (!e.faired) continue;
    total.push_back(e.total_end), curvature.push_back(e.curvature_end);
    total_run.push_back(e.total_mean), curvature_run.push_back(e.curvature_mean);
  }
  const RigidExperiment& experiment = chapter.experiment;
  return beside_paper(
      "Figs. 4 and 5",
      {{"motion", "three particles on a circle about the origin, 3 turns",
        fmt::format("the same on a small and on a large circle, {} turn{}", experiment.cycles,
                    experiment.cycles == 1 ? "" : "s")},
       {"fairing iterations a step", "10; then 10 to 50",
        fmt::format("{}", fmt::join(experiment.fairing_iterations, ", "))},
       {"radii, threshold, steps", "not stated", "see above"},
       {"where the paper's statements hold", "", "see `paper-map`"},
       {"error of total after whole turns, with fairing", fmt::format("below {}", paper.faired_error),
        range_text(total)},
       {"error of curvature (Eq. 10)", "below total's", range_text(curvature)},
       {"over the whole run", "not stated",
        fmt::format("total {}, curvature {}", range_text(total_run), range_text(curvature_run))}});
}

/// How they follow their material; the paper's claims are judged by `paper-map`, over what it leaves open.
void judge_three_particles(const PaperFigures& paper, Chapter& chapter) {
  std::vector<Check> follows;
  for (const TotalAndCurvature& e : total_and_curvature(chapter))
    follows.push_back(at_most(e.where, e.curvature_mean, kClearlyBetter * e.total_mean, "half of total's"));
  chapter.report.statements.push_back(judged(kCurvatureFollowsBetter, follows));
  chapter.report.beside = beside_three_particles(paper, chapter);
}

/// value(case) against the number of fairing iterations, a plot a body, a curve a method.
std::vector<Plot> plots_over_fairing(const Chapter& chapter, const std::string& label,
                                     const std::function<double(const RigidCase&)>& value) {
  std::vector<Plot> plots;
  for (const TrackedBody& body : chapter.experiment.bodies) {
    Plot plot{body.name, "fairing iterations a step", label, {}};
    for (const std::string& method : chapter.experiment.methods) {
      Curve curve = method_curve(method);
      for (const RigidCase& c : chapter.cases)
        if (c.body == &body && c.method == method) curve.points.emplace_back(c.fairing_iterations, value(c));
      plot.curves.push_back(std::move(curve));
    }
    plots.push_back(std::move(plot));
  }
  return plots;
}

}  // namespace

Report experiment_fig4(const ExperimentContext& context) {
  Chapter chapter = run_chapter(
      context,
      "Three equal particles turn about their centre, compact (each reaches the whole surface) and spread "
      "(much of the surface is within reach of one alone, part of a sphere). `material` interpolates "
      "particle velocities linearly, for which three particles are too few.");
  judge_three_particles(paper_figures(context), chapter);
  chapter.report.statements.push_back(regional_follows(chapter));
  std::vector<Plot> plots;
  for (const TrackedBody& body : chapter.experiment.bodies) {
    const int fairing = chapter.experiment.fairing_iterations.back();
    const auto cases = select(chapter.cases, [&](const RigidCase& c) {
      return c.body == &body && c.fairing_iterations == fairing;
    });
    add_mesh_figure(chapter, context, "fig4-" + body.name, cases,
                    fmt::format("The {} body with {} fairing iterations a step.", body.name, fairing));
    plots.push_back(error_over_turns(fmt::format("{}, {} fairing iterations", body.name, fairing), cases));
  }
  add_plots(chapter.report, context, "fig4-errors", plots,
            "Mean distance of the vertices to where the rigid motion takes them.");
  chapter.report.tables.push_back(case_table(chapter));
  return chapter.report;
}

Report experiment_fig5(const ExperimentContext& context) {
  Chapter chapter = run_chapter(
      context, "The three particles of fig4, tracked with more and more fairing iterations a step.");
  judge_three_particles(paper_figures(context), chapter);
  add_plots(chapter.report, context, "fig5",
            plots_over_fairing(chapter, "error after turns [body size]",
                               [&](const RigidCase& c) { return end_error(chapter, c); }),
            "The paper's error: distance to the start after whole turns.");
  add_plots(chapter.report, context, "fig5-run",
            plots_over_fairing(chapter, "error over the run [body size]",
                               [](const RigidCase& c) { return c.mean_over_run(); }),
            "Distance to the true trajectory, averaged over vertices and steps.");
  chapter.report.tables.push_back(case_table(chapter));
  return chapter.report;
}

}  // namespace kappaflow
