// What papers and other programs report, to compare with. The numbers lie in scenes/experiments/data, each
// file with where they are from.
#pragma once

#include <string>
#include <vector>

#include "core/types.h"
#include "tools/experiments/experiment.h"
#include "tools/pictures/report.h"

namespace kappaflow {

/// Fronts of a collapsing column: (T, Z), in the order of T; two or more.
struct MeasuredFronts {
  std::string name, figure;
  std::vector<Vec2> points;
};
/// martin_moyce_1952.toml. This and the following throw InvalidInput "file:line:column: ...".
MeasuredFronts measured_fronts(const ExperimentContext& context);

/// Outlines of liquid that spreads on an incline from the origin, in the order of their times; one or more.
struct MeasuredOutlines {
  struct Outline {
    double time = 0;           ///< [s]
    std::vector<Vec2> points;  ///< (down the slope, across it), half of it [m]
  };
  std::string name, figure;
  std::vector<Outline> outlines;
};
/// lister_1992.toml.
MeasuredOutlines measured_outlines(const ExperimentContext& context);

/// Errors after whole turns, in body sizes.
struct PaperFigures {
  std::string source;
  double faired_error = 0;          ///< total and curvature stay below it, with fairing
  double total_after_30_turns = 0;  ///< about
};
/// fujisawa_2011.toml.
PaperFigures paper_figures(const ExperimentContext& context);

/// enright_programs.toml: a row a program.
Table enright_programs(const ExperimentContext& context);

/// level_set_papers.toml: a row a method that others print figures of.
Table level_set_papers(const ExperimentContext& context);

}  // namespace kappaflow
