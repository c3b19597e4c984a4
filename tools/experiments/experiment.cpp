#include "tools/experiments/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <system_error>

#include "core/errors.h"
#include "core/suggestion.h"
#include "core/version.h"
#include "tools/experiments/bodies.h"
#include "tools/experiments/channel_flow.h"
#include "tools/experiments/coiling.h"
#include "tools/experiments/conduction.h"
#include "tools/experiments/conservation.h"
#include "tools/experiments/cooling_film.h"
#include "tools/experiments/dam_break.h"
#include "tools/experiments/enright.h"
#include "tools/experiments/fig9.h"
#include "tools/experiments/folding.h"
#include "tools/experiments/gravity_current.h"
#include "tools/experiments/hydrostatic.h"
#include "tools/experiments/incline.h"
#include "tools/experiments/kernels.h"
#include "tools/experiments/level_sets.h"
#include "tools/experiments/minimiser_comparison.h"
#include "tools/experiments/motions.h"
#include "tools/experiments/paper_map.h"
#include "tools/experiments/plane_flow.h"
#include "tools/experiments/rigid_figures.h"
#include "tools/experiments/rising_drop.h"
#include "tools/experiments/slump.h"
#include "tools/experiments/validation.h"
#include "tools/io/files.h"
#include "tools/runs/program_file.h"
#include "tools/runs/progress.h"
#include "tools/runs/run_record.h"
#include "tools/runs/timings.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;
using InAll = Experiment::InAll;

constexpr const char* kReportFile = "report.md";

const Experiment& experiment_named(std::string_view name) {
  for (const Experiment& experiment : experiments())
    if (experiment.name == name) return experiment;
  std::vector<std::string_view> names{"all", "validate"};
  for (const Experiment& experiment : experiments()) names.push_back(experiment.name);
  throw InvalidInput(fmt::format("unknown experiment \"{}\"; experiments are {}{}", name,
                                 fmt::join(names, ", "), suggestion(name, names)));
}

bool is_in_all(const Experiment& experiment, bool quick) {
  return experiment.in_all == InAll::yes || (quick && experiment.in_all == InAll::if_quick);
}

std::vector<const Experiment*> chosen(const ExperimentOptions& options) {
  std::vector<const Experiment*> result;
  const auto add = [&](const Experiment& experiment) {
    if (std::ranges::find(result, &experiment) == result.end()) result.push_back(&experiment);
  };
  for (const std::string& name : options.names) {
    if (name != "all" && name != "validate") {
      add(experiment_named(name));
      continue;
    }
    for (const Experiment& experiment : experiments())
      if (experiment.name.starts_with(kValidationPrefix)
              ? name == "validate"
              : name == "all" && is_in_all(experiment, options.quick))
        add(experiment);
  }
  return result;
}

/// The folder of the installed scenes beside the program, or that of the source tree.
fs::path default_scenes() {
  const fs::path installed = program_file().parent_path().parent_path() / "share/kappaflow/scenes";
  std::error_code ignored;  // a folder that cannot be examined is not there
  return fs::is_directory(installed, ignored) ? installed : fs::path(KAPPAFLOW_SCENES_DIR);
}

/// Limits of validations are those of the whole variant: a smaller one that misses some tells nothing.
void doubt_failures(Report& report) {
  for (Statement& statement : report.statements)
    if (statement.verdict != Verdict::holds) statement.verdict = Verdict::too_coarse;
}

Report with_folder(Report report, const std::string& folder) {
  for (Figure& figure : report.figures) figure.file = fmt::format("{}/{}", folder, figure.file);
  for (std::string& file : report.files) file = fmt::format("{}/{}", folder, file);
  return report;
}

/// Of a path the last name.
std::string last_part(const std::string& path) {
  const fs::path whole(path);
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

/// The command without folders of this machine.
std::string command_text(const std::vector<std::string>& words) {
  std::vector<std::string> shown;
  for (const std::string& word : words) {
    const std::size_t path = word.starts_with("--") ? word.find('=') + 1 : 0;
    const bool from_root = shown.empty() || (path < word.size() && word[path] == '/');
    shown.push_back(from_root ? word.substr(0, path) + last_part(word.substr(path)) : word);
  }
  return fmt::format("{}", fmt::join(shown, " "));
}

std::string report_title(const std::vector<const Experiment*>& list, bool quick) {
  const bool validations = std::ranges::all_of(
      list, [](const Experiment* experiment) { return experiment->name.starts_with(kValidationPrefix); });
  return fmt::format("kappaflow {}{}", validations ? "validations" : "experiments", quick ? " (quick)" : "");
}

}  // namespace

void ExperimentContext::say(const std::string& text) const {
  if (!options.quiet) draw_status_line(fmt::format("{}: {}", name, text));
}

void add_plots(Report& report, const ExperimentContext& context, const std::string& name,
               std::span<const Plot> plots, const std::string& caption) {
  draw_plots(context.folder, name, plots);
  report.figures.push_back(
      {name + ".png", caption, plots.size() > 1 ? Figure::Kind::page_plot : Figure::Kind::column_plot});
}

Table beside_paper(const std::string& figure, std::vector<std::vector<std::string>> rows) {
  return {"", {figure, "Fujisawa et al. 2011", "here"}, std::move(rows)};
}

void add_smaller(Report& report, const std::string& what, const std::string& has, const std::string& whole) {
  if (has == whole) return;
  report.smaller +=
      fmt::format("{}{} {} instead of {}", report.smaller.empty() ? "" : ", ", what, has, whole);
}

std::span<const Experiment> experiments() {
  static constexpr std::array table{
      Experiment{"fig3", "experiments/fig3.toml", "one particle in a straight line: the triangles",
                 experiment_fig3},
      Experiment{"fig4", "experiments/fig4.toml", "three particles, three turns, with fairing",
                 experiment_fig4},
      Experiment{"fig5", "experiments/fig5.toml", "their error against the number of fairing iterations",
                 experiment_fig5},
      Experiment{"fig7", "experiments/fig7.toml", "one particle, thirty turns: the meshes (Figs. 6 and 7)",
                 experiment_fig7},
      Experiment{"fig8", "experiments/fig8.toml", "one particle, thirty turns: the error turn by turn",
                 experiment_fig8},
      Experiment{"paper-map", "experiments/paper-map.toml",
                 "where the statements on Figs. 4, 5 and 8 hold, over what the paper leaves open",
                 experiment_paper_map},
      Experiment{"body", "experiments/body.toml", "seven unequal particles, ten turns: features everywhere",
                 experiment_body},
      Experiment{"motions", "experiments/motions.toml",
                 "every method at one instant: known motions of a body, frames of a real flow",
                 experiment_motions},
      Experiment{"kernels", "experiments/kernels.toml",
                 "round kernels and those that follow the liquid: how smooth, where, how well followed",
                 experiment_kernels},
      Experiment{"minimisers", "experiments/minimisers.toml",
                 "Powell's method, BFGS and the closed form on Eq. 10: agreement and cost",
                 experiment_minimisers},
      Experiment{"fig9", "staircase.toml", "a viscous ball slides and rolls down a staircase",
                 experiment_fig9, "staircase-small.toml"},
      Experiment{"enright", "experiments/enright.toml",
                 "Enright's test: a sphere is drawn out into a sheet and back; particles carried by the flow",
                 experiment_enright_particles},
      Experiment{"enright-exact", "experiments/enright.toml",
                 "the same on the exact implicit function; minutes, and not part of \"all\"",
                 experiment_enright_exact, "", InAll::if_quick},
      Experiment{"level-sets", "experiments/level-sets.toml",
                 "level sets on grids beside tracked surfaces; takes OpenVDB, and not part of \"all\"",
                 experiment_level_sets, "", InAll::no},
      Experiment{"validate-poiseuille", "experiments/validate-poiseuille.toml",
                 "plane Poiseuille flow between plates: profile and order", validate_poiseuille},
      Experiment{"validate-couette", "experiments/validate-couette.toml",
                 "plane Couette flow between moving plates: profile and order", validate_couette},
      Experiment{"validate-hydrostatic", "experiments/validate-hydrostatic.toml",
                 "liquid at rest in a basin: pressure and level", validate_hydrostatic},
      Experiment{"validate-dam-break", "experiments/validate-dam-break.toml",
                 "the front of a collapsing column against Martin & Moyce (1952)", validate_dam_break},
      Experiment{"validate-gravity-current", "experiments/validate-gravity-current.toml",
                 "viscous liquid spreads on a floor: Huppert's (1982) similarity solution",
                 validate_gravity_current},
      Experiment{"validate-incline", "experiments/validate-incline.toml",
                 "silicone oil from a hole in an incline: outlines of Lister (1992), thin-film theory",
                 validate_incline},
      Experiment{"validate-coiling", "experiments/validate-coiling.toml",
                 "a thread coils on a plate: frequency of a slender thread (Ribe 2004)", validate_coiling},
      Experiment{"validate-folding", "experiments/validate-folding.toml",
                 "a strip folds on a plate: frequency of a slender strip (Ribe 2003)", validate_folding},
      Experiment{"validate-power-law", "experiments/validate-power-law.toml",
                 "plane Poiseuille flow of a power-law liquid", validate_power_law},
      Experiment{"validate-bingham", "experiments/validate-bingham.toml",
                 "plane Poiseuille flow of a Bingham liquid: profile and plug", validate_bingham},
      Experiment{"validate-carreau", "experiments/validate-carreau.toml",
                 "plane Couette flow of a Carreau liquid under a Newtonian one", validate_carreau},
      Experiment{"validate-slump", "experiments/validate-slump.toml",
                 "a cylinder of a Bingham liquid slumps: its final height", validate_slump},
      Experiment{"validate-conduction", "experiments/validate-conduction.toml",
                 "heat enters a layer: Fourier series", validate_conduction},
      Experiment{"validate-cooling", "experiments/validate-cooling.toml",
                 "a sphere cools in the air: series for a Biot number of 1", validate_cooling},
      Experiment{"validate-cooling-film", "experiments/validate-cooling-film.toml",
                 "a layer of lava flows down a slope, cools and stiffens", validate_cooling_film},
      Experiment{"validate-floating-box", "experiments/validate-floating-box.toml",
                 "a box floats: Archimedes' level, and back to it", validate_floating_box},
      Experiment{"validate-sinking-sphere", "experiments/validate-sinking-sphere.toml",
                 "a sphere sinks in a jar: Stokes' speed between walls", validate_sinking_sphere},
      Experiment{"validate-rising-drop", "experiments/validate-rising-drop.toml",
                 "a light drop rises in a jar: Hadamard's speed between walls", validate_rising_drop},
      Experiment{"validate-spinning-body", "experiments/validate-spinning-body.toml",
                 "a body in a drop: momentum and energy of both", validate_spinning_body},
      Experiment{"validate-drop", "experiments/validate-drop.toml",
                 "a spinning drop: linear and angular momentum", validate_drop},
      Experiment{"validate-basin", "experiments/validate-basin.toml",
                 "liquid at rest over a step: speeds and kinetic energy", validate_basin},
      Experiment{"validate-falling", "experiments/validate-falling.toml",
                 "thin liquid falls off stairs: speeds against free fall", validate_falling},
  };
  return table;
}

void run_experiments(const ExperimentOptions& options) {
  const std::vector<const Experiment*> list = chosen(options);
  if (fs::exists(options.folder / kReportFile) && !options.force)
    throw InvalidInput(
        fmt::format("{} already holds a report; --force replaces it", options.folder.string()));
  require_gnuplot();
  const fs::path scenes = options.scenes.empty() ? default_scenes() : options.scenes;
  const ReportHead head{report_title(list, options.quick), fmt::format("kappaflow {}", kVersion),
                        command_text(options.command), time_now()};
  std::vector<Report> reports;
  for (const Experiment* experiment : list) {
    const std::string name(experiment->name);
    make_folder(options.folder / name);
    const bool other_file = options.quick && !experiment->quick_file.empty();
    const std::string_view file = other_file ? experiment->quick_file : experiment->file;
    const ExperimentContext context{options, scenes / file, options.folder / name, name};
    const Stopwatch watch;
    Report report = with_folder(experiment->run(context), name);
    report.seconds = watch.seconds();
    if (options.quick && name.starts_with(kValidationPrefix)) doubt_failures(report);
    if (!options.quiet) {
      draw_status_line("");
      fmt::print("{:<24} {:7.1f} s  {}\n", name, report.seconds, experiment->summary);
      std::fflush(stdout);
    }
    reports.push_back(std::move(report));
    // After each: whoever waits can read, and an interrupt loses the experiment in hand only.
    write_report(options.folder, head, reports);
  }
  if (!options.quiet) fmt::print("{}\n", (options.folder / "report.html").string());
}

}  // namespace kappaflow
