#include "tools/experiments/rigid_chapter.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/pictures/method_curve.h"

namespace kappaflow {
namespace {

constexpr double kFollowsRigid = 1e-4;  // RK4's phase error in 40 steps is 1.6e-5 a turn

const Claim kRegionalFollowsRigid{
    "kappaflow",
    "Without fairing, the regional velocity stays within 1e-4 of the true trajectory, on average over the "
    "run.",
    "Mean distance [body size]. Its rows hold exactly for every rigid motion, and neighbours speak where a "
    "point alone cannot."};

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

}  // namespace

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

Plot plot_over_time(const std::string& title, const std::string& x_label, const std::string& y_label,
                    const std::vector<const RigidCase*>& cases, std::size_t first,
                    const std::function<double(const RigidSample&)>& value) {
  Plot plot{title, x_label, y_label, {}, true};
  for (const RigidCase* c : cases) {
    Curve curve = method_curve(c->method);
    for (std::size_t s = first; s < c->samples.size(); ++s)
      curve.points.emplace_back(c->samples[s].cycle, value(c->samples[s]));
    plot.curves.push_back(std::move(curve));
  }
  return plot;
}

Plot error_over_turns(const std::string& title, const std::vector<const RigidCase*>& cases) {
  return plot_over_time(title, "turns", "distance [body size]", cases, 1,
                        [](const RigidSample& s) { return s.mean_error; });
}

Statement regional_follows(const Chapter& chapter) {
  std::vector<Check> checks;
  checks.reserve(chapter.experiment.bodies.size());
  for (const TrackedBody& body : chapter.experiment.bodies)
    checks.push_back(
        at_most(body.name,
                find_case(chapter.cases, body.name, "regional", chapter.experiment.integrators.front(), 0)
                    .mean_over_run(),
                kFollowsRigid));
  return judged(kRegionalFollowsRigid, checks);
}

}  // namespace kappaflow
