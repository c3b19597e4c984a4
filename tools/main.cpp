// The command line: what it accepts, and how errors leave the program.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>

#include "core/errors.h"
#include "core/version.h"
#include "surface/motion/velocity.h"
#include "tools/benchmark.h"
#include "tools/check.h"
#include "tools/compare.h"
#include "tools/experiments/experiment.h"
#include "tools/probe.h"
#include "tools/render.h"
#include "tools/run.h"
#include "tools/run_record.h"
#include "tools/track.h"
#include "tools/virtual_display.h"

namespace {

using namespace kappaflow;

constexpr int kExitUsage = 2;
constexpr int kExitUnexpected = 1;

constexpr const char* kExitCodes =
    "Exit codes:\n"
    "  0 done   2 wrong input or command line   3 the simulation failed   4 broken mesh\n"
    "  5 a file cannot be read or written   130 interrupted (Ctrl-C)   143 ended (SIGTERM)";

std::string footer(const std::string& example) {
  return "Example:\n  " + example + "\n\n" + kExitCodes;
}

std::string method_lines() {
  std::string text = "Velocity methods:\n";
  for (const VelocityMethod& method : velocity_methods())
    text += fmt::format("  {:<16} {}\n", method.name, method.summary);
  return text;
}

std::vector<std::string_view> method_names() {
  std::vector<std::string_view> names;
  for (const VelocityMethod& method : velocity_methods()) names.push_back(method.name);
  return names;
}

std::vector<std::string_view> minimiser_names() {
  std::vector<std::string_view> names;
  for (const Named<Minimiser>& minimiser : kMinimisers) names.push_back(minimiser.name);
  return names;
}

// Validators see the words before CLI11 converts them; an empty result means that the word is fine.
CLI::Validator number_in(const std::string& what, const std::function<bool(double)>& allowed) {
  return CLI::Validator(
      [=](const std::string& word) {
        char* end = nullptr;
        const double value = std::strtod(word.c_str(), &end);
        const bool is_number = end != word.c_str() && *end == '\0' && std::isfinite(value);
        return is_number && allowed(value) ? std::string()
                                           : fmt::format("found \"{}\"; expected {}", word, what);
      },
      "");
}

CLI::Validator whole_number(long lowest, long highest) {
  return number_in(fmt::format("a whole number from {} to {}", lowest, highest), [=](double value) {
    return value == std::floor(value) && value >= static_cast<double>(lowest) &&
           value <= static_cast<double>(highest);
  });
}

CLI::Validator one_of(const std::vector<std::string_view>& names) {
  return CLI::Validator(
      [names](const std::string& word) {
        if (std::ranges::find(names, word) != names.end()) return std::string();
        return fmt::format("found \"{}\"; expected one of {}", word, fmt::join(names, ", "));
      },
      "");
}

void reject_repeated(const std::string& option, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (std::find(names.begin(), names.begin() + i, names[i]) != names.begin() + i)
      throw InvalidInput(fmt::format("{}: \"{}\" is named twice", option, names[i]));
}

/// Everything that the command line can say.
struct CommandLine {
  RunOptions run;
  double duration = 0;
  TrackOptions track;
  std::filesystem::path check_scene;
  BenchmarkOptions benchmark;
  ProbeOptions probe;
  RenderOptions render;
  CompareOptions compare;
  ExperimentOptions experiment;
  int threads = 0;  // 0: all cores
};

void add_threads(CLI::App& command, CommandLine& line) {
  command.add_option("--threads", line.threads, "Number of threads (default: all cores)")
      ->check(whole_number(1, 1024));
}

void add_methods(CLI::App& command, const std::string& name, std::vector<std::string>& methods,
                 const std::string& text) {
  command.add_option(name, methods, text)
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAMES")
      ->check(one_of(method_names()));
}

/// Calls set(Minimiser) where the option is given.
template <class Set>
void add_minimiser(CLI::App& command, const std::string& fallback, const Set& set) {
  const auto set_by_name = [set](const std::string& name) {
    for (const Named<Minimiser>& minimiser : kMinimisers)
      if (minimiser.name == name) set(minimiser.value);
  };
  command
      .add_option_function<std::string>(
          "--minimiser", set_by_name,
          fmt::format("How least squares for velocities are solved: {} (default: {})",
                      fmt::join(minimiser_names(), ", "), fallback))
      ->type_name("NAME")
      ->check(one_of(minimiser_names()));
}

/// Mesh files beside VTK's, which are always written.
void add_formats(CLI::App& command, std::vector<MeshFormat>& formats) {
  const auto set = [&formats](const std::vector<std::string>& names) {
    for (const Named<MeshFormat>& format : kMeshFormats)
      if (std::ranges::find(names, format.name) != names.end()) formats.push_back(format.value);
  };
  command
      .add_option_function<std::vector<std::string>>(
          "--format", set, "Surface files: vtk (always written), obj, ply (default: vtk)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NAMES")
      ->check(one_of({"vtk", "obj", "ply"}));
}

CLI::App* add_run(CLI::App& app, CommandLine& line) {
  CLI::App* run = app.add_subcommand("run", "Simulate a scene and track its surface");
  CLI::Option* scene = run->add_option("SCENE", line.run.scene, "Scene file (.toml)");
  CLI::Option* resume = run->add_option("--resume", line.run.resume,
                                        "Go on with the interrupted run in this folder, with its options")
                            ->type_name("DIR");
  run->add_option("--out", line.run.folder, "Folder for the results (default: out/<name of the scene>)");
  add_methods(*run, "--track", line.run.methods, "Velocity methods to track with (default: the scene's)");
  run->add_option("--duration", line.duration, "Simulated time in seconds (default: the scene's)")
      ->check(number_in("a number of seconds above 0", [](double value) { return value > 0; }));
  add_minimiser(*run, "the scene's", [&line](Minimiser minimiser) { line.run.minimiser = minimiser; });
  add_formats(*run, line.run.formats);
  add_threads(*run, line);
  run->add_flag("--force", line.run.force, "Replace the run that the folder already holds");
  run->add_flag("--quiet", line.run.quiet, "Print errors only");
  for (const char* name : {"--out", "--track", "--duration", "--minimiser", "--format", "--force"})
    resume->excludes(run->get_option(name));
  run->callback([scene, resume] {
    if (scene->empty() && resume->empty()) throw CLI::RequiredError("SCENE or --resume");
  });
  run->footer(method_lines() + "\n" +
              footer("kappaflow run scenes/staircase.toml --track total,curvature --threads 4\n"
                     "  kappaflow run --resume out/staircase"));
  return run;
}

/// An option that takes a number above 0.
void add_positive(CLI::App& command, const std::string& name, std::optional<double>& value,
                  const std::string& text) {
  command
      .add_option_function<double>(
          name, [&value](double number) { value = number; }, text)
      ->type_name("NUMBER")
      ->check(number_in("a number above 0", [](double number) { return number > 0; }));
}

CLI::App* add_track(CLI::App& app, CommandLine& line) {
  CLI::App* track = app.add_subcommand("track", "Track the surface of particles that another program wrote");
  track
      ->add_option("FILES", line.track.inputs,
                   "Particles, a file a frame (.vtk, .vtp, .vtu, .csv): names or a pattern in quotes")
      ->required();
  track->add_option("--out", line.track.folder, "Folder for the results (default: out/<name of the files>)");
  add_methods(*track, "--velocity", line.track.methods,
              "Velocity methods (default: material; regional where neither velocities nor ids are known)");
  add_positive(*track, "--fps", line.track.frames_per_second,
               "Frames a second, where the files hold no times");
  add_positive(*track, "--sigma", line.track.sigma,
               "Radius of a particle's field in metres (default: 2 particle spacings)");
  add_positive(*track, "--threshold", line.track.threshold,
               "Value of the field at its surface (default: half its median at the particles)");
  track
      ->add_option_function<std::string>(
          "--weights",
          [&line](const std::string& name) {
            line.track.weights = name == "uniform" ? WeightRule::uniform : WeightRule::normalised;
          },
          "Weights of the particles: uniform, or normalised, which keeps lone drops (default: uniform)")
      ->type_name("NAME")
      ->check(one_of({"uniform", "normalised"}));
  add_formats(*track, line.track.formats);
  add_threads(*track, line);
  track->add_flag("--force", line.track.force, "Replace the run that the folder already holds");
  track->add_flag("--quiet", line.track.quiet, "Print errors only");
  track->footer(method_lines() + "\n" +
                footer("kappaflow track 'frames/*.vtk' --velocity regional --fps 25 --out out/tracked"));
  return track;
}

CLI::App* add_check(CLI::App& app, CommandLine& line) {
  CLI::App* check = app.add_subcommand("check", "Check a scene and say what it will cost");
  check->add_option("SCENE", line.check_scene, "Scene file (.toml)")->required();
  add_threads(*check, line);
  check->footer(footer("kappaflow check scenes/staircase.toml"));
  return check;
}

CLI::App* add_benchmark(CLI::App& app, CommandLine& line) {
  CLI::App* benchmark =
      app.add_subcommand("benchmark", "Time the solver's phases on a scene, at several sizes and threads");
  benchmark->add_option("SCENE", line.benchmark.scene, "Scene file (.toml)")->required();
  benchmark
      ->add_option("--particles", line.benchmark.particles,
                   "Numbers of particles, reached by another spacing (default: the scene's)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NUMBERS")
      ->check(whole_number(100, 100000000));
  benchmark->add_option("--threads", line.benchmark.threads, "Numbers of threads (default: all cores)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NUMBERS")
      ->check(whole_number(1, 1024));
  benchmark->add_option("--steps", line.benchmark.steps, "Solver steps to measure (default: 20)")
      ->check(whole_number(1, 100000));
  benchmark->add_option("--out", line.benchmark.csv, "The table as CSV too");
  benchmark->footer(
      footer("kappaflow benchmark scenes/staircase.toml --particles 10000,100000 --threads 1,2"));
  return benchmark;
}

CLI::App* add_probe(CLI::App& app, CommandLine& line) {
  CLI::App* probe =
      app.add_subcommand("probe", "Print field, derivatives, curvatures and velocities at points, as CSV");
  probe
      ->add_option(
          "PARTICLES", line.probe.particles,
          "Particles: .vtp with arrays velocity, weight, sigma, or .csv with x,y,z,vx,vy,vz,weight,sigma")
      ->required();
  probe->add_option("POINTS", line.probe.points, "Points: .csv with x,y,z")->required();
  probe->add_option("--threshold", line.probe.threshold, "T of Eq. 12")
      ->required()
      ->check(number_in("a number", [](double) { return true; }));
  for (const VelocityMethod& method : velocity_methods()) line.probe.methods.emplace_back(method.name);
  add_methods(*probe, "--methods", line.probe.methods, "Velocity methods to evaluate (default: all)");
  add_minimiser(*probe, "closed-form", [&line](Minimiser minimiser) { line.probe.minimiser = minimiser; });
  probe->footer(
      method_lines() + "\n" +
      footer("kappaflow probe out/staircase/particles/particles_0010.vtp points.csv --threshold 2.6 "
             "--methods total,curvature"));
  return probe;
}

CLI::App* add_render(CLI::App& app, CommandLine& line) {
  CLI::App* render = app.add_subcommand("render", "Draw the surfaces of a run side by side");
  render->add_option("DIR", line.render.folder, "Run folder")->required();
  render->add_option("--out", line.render.picture, "Picture (.png)")->required();
  render->add_option("--frame", line.render.frame, "Frame (default: the last one)")
      ->check(whole_number(0, 9999999));
  add_methods(*render, "--methods", line.render.methods, "Methods to draw (default: those of the run)");
  render->add_option("--columns", line.render.columns, "Panels a row (default: all in one row)")
      ->check(whole_number(1, 100));
  render->footer(footer("kappaflow render out/staircase --out picture.png --frame 40"));
  return render;
}

CLI::App* add_compare(CLI::App& app, CommandLine& line) {
  CLI::App* compare = app.add_subcommand("compare", "Set the metrics of runs and methods side by side");
  compare->add_option("DIR", line.compare.runs, "Run folders")->required();
  compare->add_option("--out", line.compare.folder,
                      "Folder for the table as CSV and Markdown, and a plot of each metric over time");
  compare->footer(footer("kappaflow compare out/staircase out/tracked --out out/compared"));
  return compare;
}

std::string experiment_lines() {
  std::string text = "Experiments:\n";
  for (const Experiment& experiment : experiments())
    text += fmt::format("  {:<24} {}\n", experiment.name, experiment.summary);
  return text + fmt::format("  {:<24} {}\n  {:<24} {}\n", "all",
                            "those that are no validation, without --quick all but enright-exact", "validate",
                            "all validations of the solver: names that begin with \"validate-\"");
}

CLI::App* add_experiment(CLI::App& app, CommandLine& line) {
  CLI::App* experiment = app.add_subcommand(
      "experiment", "Repeat the paper's figures, with a report of what holds and what does not");
  experiment->add_option("NAMES", line.experiment.names, "Experiments, see below")->required()->type_name("");
  experiment->add_option("--out", line.experiment.folder, "Folder for report.html and the results")
      ->required();
  experiment->add_flag("--quick", line.experiment.quick, "A smaller variant of each, all in under a minute");
  add_minimiser(*experiment, "closed-form",
                [&line](Minimiser minimiser) { line.experiment.minimiser = minimiser; });
  experiment->add_option("--scenes", line.experiment.scenes,
                         "Folder with the experiments' files (default: those that came with the program)");
  add_threads(*experiment, line);
  experiment->add_flag("--force", line.experiment.force, "Replace the report that the folder already holds");
  experiment->add_flag("--quiet", line.experiment.quiet, "Print errors only");
  experiment->footer(experiment_lines() + "\n" + footer("kappaflow experiment fig4 fig5 --out out/figures"));
  return experiment;
}

// CLI11 breaks some of its messages over lines.
std::string one_line(std::string text) {
  for (std::size_t end = 0; (end = text.find('\n')) != std::string::npos;)
    text.replace(end, 1, end + 1 == text.size() ? "" : "; ");
  return text;
}

int execute(const CLI::App& app, CommandLine& line, char** argv) {
  if (app.got_subcommand("run")) {
    reject_repeated("--track", line.run.methods);
    line.run.threads = line.threads;
    if (line.duration > 0) line.run.duration = line.duration;
    return run(line.run);
  }
  if (app.got_subcommand("track")) {
    reject_repeated("--velocity", line.track.methods);
    line.track.threads = line.threads;
    return track(line.track);
  }
  if (app.got_subcommand("check")) fmt::print("{}", check_text(load_scene(line.check_scene), line.threads));
  if (app.got_subcommand("benchmark")) {
    if (line.benchmark.threads.empty()) line.benchmark.threads = {line.threads};
    fmt::print("{}", benchmark(line.benchmark));
  }
  if (app.got_subcommand("probe")) fmt::print("{}", probe(line.probe));
  if (app.got_subcommand("compare")) fmt::print("{}", compare(line.compare));
  if (app.got_subcommand("render")) {
    ensure_display(argv);
    render(line.render);
  }
  if (app.got_subcommand("experiment")) {
    ensure_display(argv);
    line.experiment.threads = line.threads;
    run_experiments(line.experiment);
  }
  return 0;
}

/// Also with more threads than there are cores.
int execute_with_threads(const CLI::App& app, CommandLine& line, char** argv) {
  if (line.threads == 0) line.threads = tbb::this_task_arena::max_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(line.threads));
  return tbb::task_arena(line.threads).execute([&] { return execute(app, line, argv); });
}

int parse_and_execute(int argc, char** argv) {
  CommandLine line;
  line.run.command.assign(argv, argv + argc);
  line.track.command = line.run.command;
  CLI::App app("kappaflow: viscous SPH liquids with a tracked, textured surface", "kappaflow");
  app.set_version_flag("--version", fmt::format("kappaflow {}\n{}", kVersion, build_description()));
  app.footer(footer("kappaflow run scenes/staircase.toml"));
  app.require_subcommand(1);
  const std::vector<CLI::App*> commands{
      add_run(app, line),   add_track(app, line),  add_check(app, line),      add_benchmark(app, line),
      add_probe(app, line), add_render(app, line), add_experiment(app, line), add_compare(app, line)};
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    return app.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    std::string help = "kappaflow --help";
    for (const CLI::App* command : commands)
      if (command->parsed()) help = fmt::format("kappaflow {} --help", command->get_name());
    fmt::print(stderr, "kappaflow: error: {}; see {}\n", one_line(error.what()), help);
    return kExitUsage;
  }
  return execute_with_threads(app, line, argv);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return parse_and_execute(argc, argv);
  } catch (const kappaflow::Error& error) {
    fmt::print(stderr, "kappaflow: error: {}\n", error.what());
    return error.exit_code();
  } catch (const std::exception& error) {
    fmt::print(stderr, "kappaflow: error: {}\n", one_line(error.what()));
    return kExitUnexpected;
  }
}
