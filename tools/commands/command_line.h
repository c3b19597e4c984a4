// What the command line can say, command by command.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

#include "tools/commands/benchmark.h"
#include "tools/commands/compare.h"
#include "tools/commands/convert.h"
#include "tools/commands/probe.h"
#include "tools/experiments/experiment.h"
#include "tools/pictures/page.h"
#include "tools/pictures/render.h"
#include "tools/runs/run.h"
#include "tools/runs/track.h"

namespace kappaflow {

/// Everything that the command line can say.
struct CommandLine {
  RunOptions run;
  double duration = 0;
  TrackOptions track;
  std::filesystem::path check_scene;
  BenchmarkOptions benchmark;
  ProbeOptions probe;
  RenderOptions render;
  PageOptions page;
  ConvertOptions convert;
  CompareOptions compare;
  ExperimentOptions experiment;
  int threads = 0;             // 0: all cores
  std::vector<double> shares;  // of the ranks; empty: all the same
};

/// Each adds its command and the options of it, which set members of `line`; that must outlive `app`.
void add_track(CLI::App& app, CommandLine& line);
void add_check(CLI::App& app, CommandLine& line);
void add_benchmark(CLI::App& app, CommandLine& line);
void add_probe(CLI::App& app, CommandLine& line);
void add_render(CLI::App& app, CommandLine& line);
void add_page(CLI::App& app, CommandLine& line);
void add_convert(CLI::App& app, CommandLine& line);
void add_compare(CLI::App& app, CommandLine& line);
void add_experiment(CLI::App& app, CommandLine& line);

}  // namespace kappaflow
