// What the chapters on bodies in rigid motion have in common: how they begin, their table, figures and plots.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/experiments/rigid_experiment.h"

namespace kappaflow {

/// What every chapter of this kind consists of; statements, figures and tables follow.
struct Chapter {
  RigidExperiment experiment;
  std::vector<RigidCase> cases;
  Report report;
};

/// Runs the experiment of the context's file, writes its results, and begins its report.
Chapter run_chapter(const ExperimentContext& context, const std::string& introduction);

/// The paper's error of a case at the end: mean distance to the start after whole turns [body size].
double end_error(const Chapter& chapter, const RigidCase& c);

/// What the regional velocity promises on every rigid body, without fairing.
Statement regional_follows(const Chapter& chapter);

/// A row a case: the two error measures, and the triangles at the end.
Table case_table(const Chapter& chapter);

/// Draws the kept meshes of the cases as `name`.png.
void add_mesh_figure(Chapter& chapter, const ExperimentContext& context, const std::string& name,
                     const std::vector<const RigidCase*>& cases, const std::string& caption);

/// value(sample) over time from sample `first` on, a curve a case that is named by its method.
Plot plot_over_time(const std::string& title, const std::string& x_label, const std::string& y_label,
                    const std::vector<const RigidCase*>& cases, std::size_t first,
                    const std::function<double(const RigidSample&)>& value);

/// mean_error turn by turn; at the start it is 0, which has no logarithm.
Plot error_over_turns(const std::string& title, const std::vector<const RigidCase*>& cases);

}  // namespace kappaflow
