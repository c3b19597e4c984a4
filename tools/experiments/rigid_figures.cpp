#include "tools/experiments/rigid_figures.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/experiments/rigid_experiment.h"
#include "tools/pictures/plot.h"

namespace kappaflow {
namespace {

constexpr const char* kPaper = "Fujisawa et al. 2011";
constexpr const char* kOurs = "kappaflow";

/// What every chapter of this kind consists of; statements, figures and tables follow.
struct Chapter {
  RigidExperiment experiment;
  std::vector<RigidCase> cases;
  Report report;
};

/// What the quick variant leaves out of the whole experiment.
void describe_smaller(const ExperimentContext& context, Chapter& chapter) {
  if (!context.options.quick) return;
  const RigidExperiment whole = read_rigid_experiment(context.file, false), &quick = chapter.experiment;
  const auto text = [](const auto& value) { return fmt::format("{}", value); };
  const auto fairing = [](const RigidExperiment& e) {
    return fmt::format("{}", fmt::join(e.fairing_iterations, ", "));
  };
  const auto edges = [](const RigidExperiment& e) {
    return fmt::format("{} m", e.bodies.front().edge_length);
  };
  add_smaller(chapter.report, "turns", text(quick.cycles), text(whole.cycles));
  add_smaller(chapter.report, "fairing iterations", fairing(quick), fairing(whole));
  add_smaller(chapter.report, "mesh edges", edges(quick), edges(whole));
}

Chapter run_chapter(const ExperimentContext& context, const std::string& introduction) {
  Chapter chapter;
  chapter.experiment = read_rigid_experiment(context.file, context.options.quick);
  chapter.cases = run_rigid_experiment(chapter.experiment, context);
  chapter.report.name = context.name;
  chapter.report.title = chapter.experiment.title;
  chapter.report.introduction = introduction + "\n\n" + rigid_setting(chapter.experiment);
  chapter.report.files = write_rigid_results(chapter.experiment, chapter.cases, context);
  describe_smaller(context, chapter);
  return chapter;
}

double end_error(const Chapter& chapter, const RigidCase& c) {
  return c.end_error(chapter.experiment.cycles, chapter.experiment.steps_per_cycle);
}

/// A row a case: the two error measures, and the triangles at the end.
Table case_table(const Chapter& chapter) {
  Table table{"All cases.",
              {"body", "method", "integrator", "fairing", "end error", "mean over run", "maximum over run",
               "aspect ratio at end, max", "area over area at rest", "not on the surface"},
              {}};
  for (const RigidCase& c : chapter.cases) {
    const RigidSample& end = c.samples.back();
    table.rows.push_back(
        {c.body->name, c.method, std::string(name_of(kIntegrators, c.integrator)),
         fmt::format("{}", c.fairing_iterations), fmt::format("{:.3g}", end_error(chapter, c)),
         fmt::format("{:.3g}", c.mean_over_run()), fmt::format("{:.3g}", c.max_over_run()),
         fmt::format("{:.3g}", end.distortion.aspect_max),
         fmt::format("{:.3g} to {:.3g}", end.distortion.area_ratio_min, end.distortion.area_ratio_max),
         fmt::format("{}", end.unprojected)});
  }
  return table;
}

void add_mesh_figure(Chapter& chapter, const ExperimentContext& context, const std::string& name,
                     const std::vector<const RigidCase*>& cases, const std::string& caption) {
  context.say("drawing " + name + ".png");
  draw_rigid_meshes(chapter.experiment, cases, name, context);
  chapter.report.figures.push_back({name + ".png", caption});
}

void add_plots(Chapter& chapter, const ExperimentContext& context, const std::string& name,
               const std::vector<Plot>& plots, const std::string& caption) {
  draw_plots(context.folder, name, plots);
  chapter.report.figures.push_back({name + ".png", caption});
  chapter.report.files.push_back(name + ".gp");
}

/// value(sample) over time from `first` on, a curve a case that is named by its method.
Plot plot_over_time(const std::string& title, const std::string& x_label, const std::string& y_label,
                    const std::vector<const RigidCase*>& cases, std::size_t first,
                    const std::function<double(const RigidSample&)>& value) {
  Plot plot{title, x_label, y_label, {}, true};
  for (const RigidCase* c : cases) {
    Curve curve{c->method, {}};
    for (std::size_t s = first; s < c->samples.size(); ++s)
      curve.points.emplace_back(c->samples[s].cycle, value(c->samples[s]));
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

/// mean_error turn by turn; at the start it is 0, which has no logarithm.
Plot error_over_turns(const std::string& title, const std::vector<const RigidCase*>& cases) {
  return plot_over_time(title, "turns", "mean distance to the true place [body size]", cases, 1,
                        [](const RigidSample& s) { return s.mean_error; });
}

std::string numbers(const std::vector<std::pair<std::string, double>>& values) {
  std::string text;
  for (const auto& [name, value] : values)
    text += fmt::format("{}{} {:.3g}", text.empty() ? "" : ", ", name, value);
  return text;
}

/// What the regional velocity promises on every rigid body, without fairing.
void judge_regional(Chapter& chapter) {
  std::vector<Check> checks;
  std::vector<std::pair<std::string, double>> means;
  for (const RigidBody& body : chapter.experiment.bodies) {
    const RigidCase& regional =
        find_case(chapter.cases, body.name, "regional", chapter.experiment.integrators.front(), 0);
    means.emplace_back(body.name, regional.mean_over_run());
    checks.push_back({body.name, regional.mean_over_run() <= 1e-4});
  }
  chapter.report.statements.push_back(judged(
      kOurs,
      "Without fairing, the regional velocity stays within 1e-4 of the true trajectory, on average over the "
      "run.",
      numbers(means), checks,
      "Its rows hold exactly for every rigid motion, and neighbours speak where a point alone cannot."));
}

/// The paper's claims about three particles, for the numbers of fairing iterations from 10 on.
void judge_three_particles(Chapter& chapter) {
  std::vector<Check> below, ordered, follows;
  std::string ends, means;
  for (const RigidBody& body : chapter.experiment.bodies)
    for (const int fairing : chapter.experiment.fairing_iterations) {
      const auto of = [&](const char* method) -> const RigidCase& {
        return find_case(chapter.cases, body.name, method, chapter.experiment.integrators.front(), fairing);
      };
      const RigidCase &total = of("total"), &curvature = of("curvature");
      const std::string where = fmt::format("{} with {} iterations", body.name, fairing);
      const auto line = [&](double of_total, double of_curvature) {
        return fmt::format("{}: total {:.3g}, curvature {:.3g}; ", where, of_total, of_curvature);
      };
      means += line(total.mean_over_run(), curvature.mean_over_run());
      follows.push_back({where, curvature.mean_over_run() < 0.5 * total.mean_over_run()});
      if (fairing == 0) continue;
      ends += line(end_error(chapter, total), end_error(chapter, curvature));
      below.push_back({where, end_error(chapter, total) < 0.03 && end_error(chapter, curvature) < 0.03});
      ordered.push_back({where, end_error(chapter, curvature) < end_error(chapter, total)});
    }
  auto& statements = chapter.report.statements;
  statements.push_back(
      judged(kPaper, "With fairing, the error of total and of curvature after whole turns is below 0.03.",
             ends, below,
             "The distance to the start after whole turns flatters: on a convex body total velocity keeps "
             "each vertex at its normal, so that it is back by itself after every turn without having turned "
             "with the body. The paper does not say where its particles are, nor its threshold."));
  statements.push_back(judged(kPaper, "With fairing, curvature's error after whole turns is below total's.",
                              ends, ordered,
                              "After whole turns a vertex that did not follow the body at all is back as "
                              "well; the next row has the measure that tells the two apart."));
  statements.push_back(judged(
      kOurs, "Over the whole run, curvature's distance to the true trajectory is less than half of total's.",
      means, follows,
      "Under rotation the rows of total velocity contradict those of curvature invariance, and Eq. 10 adds "
      "them up: its solution lies between the two. Where one particle alone makes the surface, K and H are "
      "constant and say nothing."));
}

}  // namespace

Report experiment_fig3(const ExperimentContext& context) {
  Chapter chapter =
      run_chapter(context,
                  "A sphere is moved in a straight line. Each method has the same normal velocity; what it "
                  "adds along the surface decides what becomes of the triangles.");
  const TimeIntegrator integrator = chapter.experiment.integrators.front();
  const auto of = [&](const char* method) -> const RigidSample& {
    return find_case(chapter.cases, "one", method, integrator, 0).samples.back();
  };
  const RigidSample& start = chapter.cases.front().samples.front();
  const auto spread = [](const RigidSample& s) {
    return s.distortion.area_ratio_max / s.distortion.area_ratio_min;
  };
  const RigidSample &normal = of("normal"), &total = of("total"), &curvature = of("curvature");
  chapter.report.statements.push_back(judged(
      std::string(kPaper) + ", Fig. 3",
      "Under a translation the normal velocity alone distorts the mesh; total and curvature keep it.",
      fmt::format("largest aspect ratio {:.3g} at the start, at the end {:.3g} (normal), {:.3g} (total), "
                  "{:.3g} (curvature); largest over smallest area ratio {:.3g}, {:.6g}, {:.6g}",
                  start.distortion.aspect_max, normal.distortion.aspect_max, total.distortion.aspect_max,
                  curvature.distortion.aspect_max, spread(normal), spread(total), spread(curvature)),
      {{"normal distorts", spread(normal) > 10},
       {"total keeps", spread(total) < 1.001},
       {"curvature keeps", spread(curvature) < 1.001}},
      "A translation changes no normal and no curvature, so both methods find it; the normal velocity leaves "
      "the vertices behind, and they gather at the back."));
  std::vector<const RigidCase*> all = select(chapter.cases, [](const RigidCase&) { return true; });
  add_mesh_figure(chapter, context, "fig3", all, "The mesh at the start and at the end of the way.");
  add_plots(chapter, context, "fig3-aspect",
            {plot_over_time("Triangles on the way", "way [1]", "largest aspect ratio", all, 0,
                            [](const RigidSample& s) { return s.distortion.aspect_max; })},
            "The largest aspect ratio of a triangle on the way.");
  chapter.report.tables.push_back(case_table(chapter));
  return chapter.report;
}

Report experiment_fig4(const ExperimentContext& context) {
  Chapter chapter = run_chapter(
      context,
      "Three equal particles turn about their centre, compact (each reaches the whole surface) and spread "
      "(much of the surface is within reach of one alone, part of a sphere). `material` interpolates "
      "particle velocities linearly, for which three particles are too few.");
  judge_three_particles(chapter);
  judge_regional(chapter);
  std::vector<Plot> plots;
  for (const RigidBody& body : chapter.experiment.bodies) {
    const int fairing = chapter.experiment.fairing_iterations.back();
    const auto cases = select(chapter.cases, [&](const RigidCase& c) {
      return c.body == &body && c.fairing_iterations == fairing;
    });
    add_mesh_figure(chapter, context, "fig4-" + body.name, cases,
                    fmt::format("The {} body with {} fairing iterations a step.", body.name, fairing));
    plots.push_back(error_over_turns(fmt::format("{}, {} fairing iterations", body.name, fairing), cases));
  }
  add_plots(chapter, context, "fig4-errors", plots,
            "Mean distance of the vertices to where the rigid motion takes them.");
  chapter.report.tables.push_back(case_table(chapter));
  return chapter.report;
}

Report experiment_fig5(const ExperimentContext& context) {
  Chapter chapter = run_chapter(
      context, "The three particles of fig4, tracked with more and more fairing iterations a step.");
  judge_three_particles(chapter);
  for (const bool whole_run : {false, true}) {
    std::vector<Plot> plots;
    for (const RigidBody& body : chapter.experiment.bodies) {
      Plot plot{body.name,
                "fairing iterations a step",
                whole_run ? "mean error over the run [body size]" : "error after whole turns [body size]",
                {}};
      for (const std::string& method : chapter.experiment.methods) {
        Curve curve{method, {}};
        for (const RigidCase* c : select(chapter.cases, [&](const RigidCase& each) {
               return each.body == &body && each.method == method;
             }))
          curve.points.emplace_back(c->fairing_iterations,
                                    whole_run ? c->mean_over_run() : end_error(chapter, *c));
        plot.curves.push_back(std::move(curve));
      }
      plots.push_back(std::move(plot));
    }
    add_plots(chapter, context, whole_run ? "fig5-run" : "fig5", plots,
              whole_run ? "Distance to the true trajectory, averaged over vertices and steps."
                        : "The paper's error: distance to the start after whole turns.");
  }
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
  const TimeIntegrator first = chapter.experiment.integrators.front();
  const RigidCase &total = find_case(chapter.cases, "one", "total", first, 0),
                  &curvature = find_case(chapter.cases, "one", "curvature", first, 0);
  chapter.report.statements.push_back(judged(
      std::string(kPaper) + ", Figs. 6 and 7",
      fmt::format("After {} turns the mesh of total velocity is visibly off, that of curvature is not.",
                  chapter.experiment.cycles),
      fmt::format("mean distance to the start with {}: total {:.3g}, curvature {:.3g}",
                  name_of(kIntegrators, first), end_error(chapter, total), end_error(chapter, curvature)),
      {{"total is off", end_error(chapter, total) > 0.02},
       {"curvature is not", end_error(chapter, curvature) < 0.5 * end_error(chapter, total)}},
      "On a sphere K and H are constant: the curvature rows of Eq. 10 are empty and both methods are one and "
      "the same. What shows is the integrator's error."));
  chapter.report.tables.push_back(case_table(chapter));
  return chapter.report;
}

Report experiment_fig8(const ExperimentContext& context) {
  Chapter chapter =
      run_chapter(context, "The particle of fig7, with each integrator: the error after each turn.");
  std::vector<Plot> plots;
  std::vector<Check> grows, differs, accurate;
  std::vector<std::pair<std::string, double>> ends;
  for (const TimeIntegrator integrator : chapter.experiment.integrators) {
    const std::string name(name_of(kIntegrators, integrator));
    const RigidCase &total = find_case(chapter.cases, "one", "total", integrator, 0),
                    &curvature = find_case(chapter.cases, "one", "curvature", integrator, 0);
    const double end_total = end_error(chapter, total), end_curvature = end_error(chapter, curvature);
    ends.emplace_back("total " + name, end_total);
    ends.emplace_back("curvature " + name, end_curvature);
    grows.push_back({"total grows, " + name, end_total > 0.01 && end_total < 0.3});
    differs.push_back({"curvature grows less, " + name, end_curvature < 0.5 * end_total});
    if (integrator == TimeIntegrator::rk4)
      accurate = {{"total", end_total <= 1e-4}, {"curvature", end_curvature <= 1e-4}};
    Plot plot{name, "turns", "error after whole turns [body size]", {}, true};
    for (const RigidCase* c : {&total, &curvature}) {
      Curve curve{c->method, {}};
      for (int turn = 1; turn <= chapter.experiment.cycles; ++turn)
        curve.points.emplace_back(turn, c->end_error(turn, chapter.experiment.steps_per_cycle));
      plot.curves.push_back(std::move(curve));
    }
    plots.push_back(std::move(plot));
  }
  grows.insert(grows.end(), differs.begin(), differs.end());
  auto& statements = chapter.report.statements;
  statements.push_back(
      judged(std::string(kPaper) + ", Fig. 8",
             "Total's error grows with the turns, to about 0.06 after 30; curvature's hardly grows.",
             numbers(ends), grows,
             "On a sphere the two methods are the same, and what grows is the error of the integration in "
             "time: with Euler to the paper's order of magnitude, for both."));
  if (!accurate.empty())
    statements.push_back(judged(kOurs,
                                fmt::format("With RK4 the error after {} turns of {} steps is at most 1e-4.",
                                            chapter.experiment.cycles, chapter.experiment.steps_per_cycle),
                                numbers(ends), accurate, "The spin of a sphere is smooth in time."));
  add_plots(chapter, context, "fig8", plots, "Error after each turn.");
  chapter.report.tables.push_back(case_table(chapter));
  return chapter.report;
}

Report experiment_body(const ExperimentContext& context) {
  Chapter chapter = run_chapter(context,
                                "Seven particles of unequal size and weight: curvature varies all over the "
                                "surface, so that curvature invariance knows the motion almost everywhere.");
  const TimeIntegrator integrator = chapter.experiment.integrators.front();
  std::vector<std::pair<std::string, double>> means;
  for (const std::string& method : chapter.experiment.methods)
    means.emplace_back(method, find_case(chapter.cases, "seven", method, integrator, 0).mean_over_run());
  const auto mean = [&](const char* method) {
    return find_case(chapter.cases, "seven", method, integrator, 0).mean_over_run();
  };
  chapter.report.statements.push_back(
      judged(std::string(kPaper) + ", section 4",
             "Curvature invariance follows a rotation that total velocity does not see.", numbers(means),
             {{"the sum of Eq. 10 is below half of total's error", mean("curvature") < 0.5 * mean("total")},
              {"the curvature rows alone are", mean("curvature-only") < 0.5 * mean("total")}},
             "Mean distance to the true trajectory over the whole run. The curvature rows are exact under "
             "rotation; in Eq. 10 the rows of total velocity pull their solution away. Without the rows of "
             "total the parts of the surface that one particle alone makes are left to the damping."));
  std::vector<const RigidCase*> all = select(chapter.cases, [](const RigidCase&) { return true; });
  judge_regional(chapter);
  add_mesh_figure(chapter, context, "body", all, "The body of seven particles.");
  add_plots(chapter, context, "body-errors", {error_over_turns("Seven unequal particles", all)},
            "Mean distance of the vertices to where the rigid motion takes them.");
  chapter.report.tables.push_back(case_table(chapter));
  return chapter.report;
}

}  // namespace kappaflow
