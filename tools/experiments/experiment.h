// `kappaflow experiment`: the figures of Fujisawa, Mandachi & Miura (2011) with numbers beside the pictures,
// and validations of the solver.
//
// To add an experiment, write one function of type ExperimentFunction and add its row to the table in
// experiment.cpp. Its source has, in this order: the limits; what is claimed, as Claims; what it measures;
// and judge(), which holds the measured numbers against the limits. Numbers of others: peers.h.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/pictures/plot.h"
#include "tools/pictures/report.h"

namespace kappaflow {

struct ExperimentOptions {
  std::vector<std::string> names;  ///< of experiments, "all" or "validate"
  std::filesystem::path folder;    ///< for the results
  std::filesystem::path scenes;    ///< where the experiments' files lie; empty: those of the program
  bool quick = false;              ///< the smaller variant that each experiment's file describes
  bool force = false;              ///< replace the results that the folder already holds
  bool quiet = false;              ///< print errors only
  int threads = 1;
  std::vector<std::string> command;  ///< for the report
};

/// What an experiment function gets.
struct ExperimentContext {
  const ExperimentOptions& options;
  std::filesystem::path file;    ///< of its options or its scene
  std::filesystem::path folder;  ///< for its results
  std::string name;
  /// Says on the terminal what is being done.
  void say(const std::string& text) const;
};

/// Adds to Report::smaller what a smaller variant has in place of the whole one's, where the two differ.
void add_smaller(Report& report, const std::string& what, const std::string& has, const std::string& whole);

/// Draws the plots into the context's folder (draw_plots()), and puts them into the chapter.
void add_plots(Report& report, const ExperimentContext& context, const std::string& name,
               std::span<const Plot> plots, const std::string& caption);

/// What the paper says of a figure beside what came out here: rows of what, the paper, here.
Table beside_paper(const std::string& figure, std::vector<std::vector<std::string>> rows);

/// Runs one experiment, writes its files into context.folder, and fills in its chapter; names of files in the
/// chapter are relative to context.folder.
using ExperimentFunction = Report (*)(const ExperimentContext&);

/// A row of the table of experiments.
struct Experiment {
  std::string_view name;
  std::string_view file;     ///< relative to the folder of scenes
  std::string_view summary;  ///< one line for help texts
  ExperimentFunction run;
  std::string_view quick_file = {};  ///< of the quick variant; empty: its file's table [quick] describes that
  enum class InAll { yes, if_quick, no } in_all = InAll::yes;  ///< validations are never part of "all"
};

/// All of them, in the order in which help texts list them and "all" runs them.
std::span<const Experiment> experiments();

/// Runs the experiments and writes report.md and report.html. Throws InvalidInput for an unknown name or a
/// folder that holds a report already, IoError, and what the experiments throw.
void run_experiments(const ExperimentOptions& options);

}  // namespace kappaflow
