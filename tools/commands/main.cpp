// The command line: what it accepts, and how errors leave the program.
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/errors.h"
#include "core/version.h"
#include "scenes/prepared_scene.h"
#include "tools/commands/command_line.h"
#include "tools/commands/command_options.h"
#include "tools/commands/command_words.h"
#include "tools/commands/ranks_of_program.h"
#include "tools/pictures/virtual_display.h"
#include "tools/runs/check.h"
#include "tools/runs/run_record.h"

namespace {

using namespace kappaflow;

constexpr int kExitUnexpected = 1;
constexpr int kExitFile = 5;

void reject_repeated(const std::string& option, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (std::find(names.begin(), names.begin() + i, names[i]) != names.begin() + i)
      throw InvalidInput(fmt::format("{}: \"{}\" is named twice", option, names[i]));
}

void add_run(CLI::App& app, CommandLine& line) {
  CLI::App* run = app.add_subcommand("run", "Simulate a scene and track its surface");
  CLI::Option* scene = run->add_option("SCENE", line.run.scene, "Scene file (.toml)");
  CLI::Option* resume = add_resume(*run, line.run.resume, "");
  run->add_option("--out", line.run.folder, "Folder for the results (default: out/<name of the scene>)");
  add_methods(*run, "--track", line.run.methods, "Methods to track with (default: the scene's)");
  run->add_option("--duration", line.duration, "Simulated time in seconds (default: the scene's)")
      ->check(number_in("a number of seconds above 0", [](double value) { return value > 0; }));
  add_formats(*run, line.run.formats, true);
  add_threads(*run, line.threads);
  add_shares(*run, line.shares);
  run->add_flag("--force", line.run.force, "Replace the run that the folder already holds");
  run->add_flag("--quiet", line.run.quiet, "Print errors only");
  for (const char* name : {"--out", "--track", "--duration", "--format", "--force"})
    resume->excludes(run->get_option(name));
  run->callback([scene, resume] {
    if (scene->empty() && resume->empty()) throw CLI::RequiredError("SCENE or --resume");
  });
  run->footer(method_lines() + "\n" +
              footer("kappaflow run scenes/staircase.toml --track total,curvature --threads 4\n"
                     "  kappaflow run --resume out/staircase"));
}

// CLI11 breaks some of its messages over lines.
std::string one_line(std::string text) {
  for (std::size_t end = 0; (end = text.find('\n')) != std::string::npos;)
    text.replace(end, 1, end + 1 == text.size() ? "" : "; ");
  return text;
}

void share_liquid(const std::vector<double>& shares, Ranks* ranks) {
  if (shares.empty()) return;
  if (ranks == nullptr)
    throw InvalidInput("--shares: this is the only process; mpirun starts several, see docs/scaling.md");
  if (std::ssize(shares) != ranks->size())
    throw InvalidInput(fmt::format("--shares: found {} value{}; expected one for each of the {} ranks",
                                   shares.size(), shares.size() == 1 ? "" : "s", ranks->size()));
  ranks->set_shares(shares);
}

int execute(const CLI::App& app, CommandLine& line) {
  Ranks* const ranks = line.run.ranks;
  const bool follows = ranks != nullptr && ranks->rank() > 0;
  if (ranks != nullptr && !app.got_subcommand("run") && !app.got_subcommand("benchmark"))
    throw InvalidInput(fmt::format(
        "only kappaflow run and benchmark work on several ranks; this is one of {}", ranks->size()));
  share_liquid(line.shares, ranks);
  if (app.got_subcommand("run")) {
    reject_repeated("--track", line.run.methods);
    line.run.threads = line.threads;
    if (line.duration > 0) line.run.duration = line.duration;
    if (!follows) return run(line.run);
    follow_run(line.run);
  }
  if (app.got_subcommand("track")) {
    reject_repeated("--velocity", line.track.methods);
    line.track.threads = line.threads;
    return track(line.track);
  }
  if (app.got_subcommand("check"))
    fmt::print("{}", check_text(prepare(load_scene(line.check_scene)), line.threads));
  if (app.got_subcommand("benchmark")) {
    if (line.benchmark.threads.empty()) line.benchmark.threads = {line.threads};
    line.benchmark.ranks = ranks;
    if (follows)
      follow_benchmark(line.benchmark);
    else
      fmt::print("{}", benchmark(line.benchmark));
  }
  if (app.got_subcommand("probe")) fmt::print("{}", probe(line.probe));
  if (app.got_subcommand("compare")) fmt::print("{}", compare(line.compare));
  if (app.got_subcommand("page")) {
    reject_repeated("--methods", line.page.methods);
    fmt::print("{}", write_page(line.page));
  }
  if (app.got_subcommand("convert")) {
    reject_repeated("--methods", line.convert.methods);
    return convert(line.convert);
  }
  if (app.got_subcommand("render")) {
    const VirtualDisplay display;
    return render(line.render);
  }
  if (app.got_subcommand("experiment")) {
    const VirtualDisplay display;
    line.experiment.threads = line.threads;
    run_experiments(line.experiment);
  }
  return 0;
}

/// Also with more threads than there are cores.
int execute_with_threads(const CLI::App& app, CommandLine& line) {
  if (line.threads == 0) line.threads = tbb::this_task_arena::max_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(line.threads));
  return tbb::task_arena(line.threads).execute([&] { return execute(app, line); });
}

[[noreturn]] void refuse(const CLI::App& app, const std::string& what) {
  const auto commands = app.get_subcommands();
  throw InvalidInput(fmt::format("{}; see kappaflow {}--help", what,
                                 commands.empty() ? "" : commands.front()->get_name() + " "));
}

int parse_and_execute(int argc, char** argv, Ranks* ranks) {
  CommandLine line;
  line.run.ranks = ranks;
  line.run.command.assign(argv, argv + argc);
  line.track.command = line.run.command;
  line.experiment.command = line.run.command;
  CLI::App app("kappaflow: viscous SPH liquids with a tracked, textured surface", "kappaflow");
  app.set_version_flag("--version", fmt::format("kappaflow {}\n{}", kVersion, build_description()));
  app.footer(footer("kappaflow run scenes/staircase.toml\n  kappaflow help run"));
  app.require_subcommand(1);
  add_run(app, line);
  add_track(app, line);
  add_check(app, line);
  add_benchmark(app, line);
  add_probe(app, line);
  add_render(app, line);
  add_page(app, line);
  add_convert(app, line);
  add_experiment(app, line);
  add_compare(app, line);
  std::vector<std::string> words = understood_words(app, {argv + 1, argv + argc});
  std::ranges::reverse(words);  // as CLI11 takes them
  try {
    app.parse(std::move(words));
  } catch (const CLI::Success& help_or_version) {
    if (!app.remaining().empty()) refuse(app, misunderstood(app));
    return app.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    const std::string what = misunderstood(app);
    refuse(app, what.empty() ? one_line(error.what()) : what);
  }
  return execute_with_threads(app, line);
}

/// How the program ended: with an error unless that is empty.
struct Outcome {
  int exit_code = 0;
  std::string error;
};

Outcome outcome_of(int argc, char** argv, Ranks* ranks) {
  try {
    return {parse_and_execute(argc, argv, ranks), ""};
  } catch (const Error& error) {
    return {error.exit_code(), error.what()};
  } catch (const std::filesystem::filesystem_error& error) {
    return {kExitFile, fmt::format("{}: {}", error.path1().string(), error.code().message())};
  } catch (const std::exception& error) {
    return {kExitUnexpected, one_line(error.what())};
  }
}

void explain(const Outcome& outcome, const std::string& who = "") {
  if (!outcome.error.empty()) fmt::print(stderr, "kappaflow: error: {}{}\n", who, outcome.error);
}

/// Tells the other ranks that there is nothing more to do; after an error in the midst of what they do
/// together they do not listen.
int end_first_rank(const Outcome& outcome, Ranks& ranks) {
  explain(outcome);
  std::fflush(nullptr);
  if (ranks.busy()) ranks.abort(outcome.exit_code);
  ranks.announce({RankTask::end});
  return outcome.exit_code;
}

/// What is wrong with the command or the scene the first rank says, if it is: this one speaks only if that
/// has found nothing and begun, or of an error that came later.
int end_other_rank(const Outcome& outcome, Ranks& ranks) {
  if (!ranks.ended() && !ranks.begun()) ranks.next_order();
  if (ranks.ended()) return 0;
  explain(outcome, fmt::format("rank {}: ", ranks.rank()));
  std::fflush(nullptr);
  ranks.abort(outcome.exit_code);
  return outcome.exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  std::unique_ptr<Ranks> ranks;
  try {
    ranks = ranks_of_program();
  } catch (const Error& error) {
    explain({error.exit_code(), error.what()});
    return error.exit_code();
  }
  if (ranks == nullptr) {
    const Outcome outcome = outcome_of(argc, argv, nullptr);
    explain(outcome);
    return outcome.exit_code;
  }
  if (ranks->rank() == 0) return end_first_rank(outcome_of(argc, argv, ranks.get()), *ranks);
  if (std::freopen("/dev/null", "w", stdout) == nullptr) {  // the first rank alone speaks
    explain({kExitFile, "cannot open /dev/null"});
    ranks->abort(kExitFile);
  }
  return end_other_rank(outcome_of(argc, argv, ranks.get()), *ranks);
}
