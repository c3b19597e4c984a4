#include "tools/commands/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "core/parse_number.h"
#include "surface/motion/velocity_methods.h"
#include "tools/commands/command_options.h"
#include "tools/commands/command_words.h"
#include "tools/io/csv.h"

namespace kappaflow {
namespace {

std::string experiment_lines() {
  std::string text = "Experiments:\n";
  for (const Experiment& experiment : experiments())
    text += fmt::format("  {:<24} {}\n", experiment.name, experiment.summary);
  return text + fmt::format("  {:<24} {}\n  {:<24} {}\n", "all",
                            "those that are no validation, without --quick all but enright-exact", "validate",
                            "all validations of the solver: names that begin with \"validate-\"");
}

void add_range(CLI::App& track, FileRange& range) {
  static constexpr const char* kForm = "FIRST:LAST or FIRST:LAST:STEP, with FIRST <= LAST";
  const auto set = [&range](const std::string& word) {
    std::vector<double> numbers;
    for (const std::string_view part : csv_cells(word, ':'))
      if (const auto number = parse_number<double>(part); number && std::isfinite(*number))
        numbers.push_back(*number);
    const bool is_range = (numbers.size() == 2 || numbers.size() == 3) && numbers[0] <= numbers[1] &&
                          std::ranges::count(word, ':') + 1 == std::ssize(numbers);
    const double step = is_range && numbers.size() == 3 ? numbers[2] : 1;
    if (!is_range || step != std::floor(step) || step < 1 || step > 1e6)
      throw CLI::ValidationError("--frames", fmt::format("found \"{}\"; expected {}", word, kForm));
    range = {numbers[0], numbers[1], static_cast<int>(step), range.backward};
  };
  track
      .add_option_function<std::string>("--frames", set,
                                        "Files by the numbers in their names, every STEP-th of them; of a "
                                        ".pvd by their place in it, from 0 "
                                        "(default: all)")
      ->type_name("FIRST:LAST[:STEP]");
  track.add_flag(
      "--backward", range.backward,
      "From the last frame to the first, for where its liquid came from: the last file is at 0 s, and "
      "velocities have the other sign");
}

}  // namespace

void add_track(CLI::App& app, CommandLine& line) {
  CLI::App* track = app.add_subcommand(
      "track", "Track the surface of particles, images or meshes that another program wrote");
  CLI::Option* files = track->add_option(
      "FILES", line.track.inputs,
      "A file a frame: particles (.vtk, .vtp, .vtu, .pvtp, .pvtu, .bgeo, .hdf5, .csv), images of "
      "signed distances (.vti, .pvti, .vtk, .vdb) or closed meshes (.obj, .ply, "
      ".stl, .vtp, .vtk); names, a pattern in quotes, a folder, or a .pvd");
  CLI::Option* resume =
      add_resume(*track, line.track.resume, "; FILES: where the files are now, if elsewhere");
  track->add_option("--out", line.track.folder, "Folder for the results (default: out/<name of the files>)");
  add_methods(*track, "--velocity", line.track.methods,
              "Methods (default: material; regional where neither velocities nor ids are known)");
  add_positive(*track, "--fps", line.track.frames_per_second,
               "Frames a second, where the files hold no times");
  add_positive(*track, "--sigma", line.track.sigma,
               "Radius of a particle's field in metres (default: 2 particle spacings, 2.5 with anisotropic "
               "kernels; of images and meshes sigma is "
               "4 spacings of their grid)");
  add_positive(*track, "--threshold", line.track.threshold,
               "Value of the field at its surface (default: half its median at the particles)");
  add_range(*track, line.track.range);
  track
      ->add_option("--rest-interval", line.track.rest_interval,
                   "Frames between resets of two rest positions to blend, rest_1 and rest_2; 0: without them "
                   "(default: 0)")
      ->check(whole_number(0, 1000000));
  add_positive(*track, "--edge", line.track.edge_length,
               "Length of the mesh's edges in metres, shorter where it is curved (default: sigma / 4, half a "
               "particle spacing)");
  add_positive(*track, "--checker", line.track.checker_edge,
               "Edge of the checker's cubes in metres (default: 2.5 sigma)");
  track
      ->add_option_function<std::string>(
          "--texture",
          [&line](const std::string& name) { line.track.texture = *value_of(kTextureProjections, name); },
          "Projection of 2D texture coordinates: planar, spherical, box (default: box)")
      ->type_name("NAME")
      ->check(one_of({"planar", "spherical", "box"}));
  track
      ->add_option_function<std::string>(
          "--anchor", [&line](const std::string& name) { line.track.anchor = *value_of(kAnchors, name); },
          "What corrects the rest positions of tracked meshes: none, or particles, by their ids (default: "
          "none)")
      ->type_name("NAME")
      ->check(one_of({"none", "particles"}));
  track
      ->add_option(
          "--metrics", line.track.metrics_interval,
          "Frames from one that is compared with a fresh isosurface and with material tracers to the "
          "next, the last one apart; 0: none (default: 10)")
      ->check(whole_number(0, 1000000));
  track
      ->add_option_function<std::string>(
          "--weights",
          [&line](const std::string& name) { line.track.weights = *value_of(kWeightRules, name); },
          "Weights of the particles: uniform, or normalised, which keeps lone drops (default: uniform)")
      ->type_name("NAME")
      ->check(one_of({"uniform", "normalised"}));
  add_kernels(*track, line.track.kernels);
  add_formats(*track, line.track.formats, true);
  add_threads(*track, line.threads);
  add_force_and_quiet(*track, "run", line.track.force, line.track.quiet);
  for (const char* name : {"--out", "--velocity", "--fps", "--sigma", "--threshold", "--weights", "--kernels",
                           "--frames", "--backward", "--edge", "--checker", "--texture", "--anchor",
                           "--rest-interval", "--metrics", "--format", "--force"})
    resume->excludes(track->get_option(name));
  track->callback([files, resume] {
    if (files->empty() && resume->empty()) throw CLI::RequiredError("FILES or --resume");
  });
  track->footer(method_lines() + "\n" +
                footer("kappaflow track 'frames/*.vtk' --velocity regional --fps 25 --out out/tracked\n"
                       "  kappaflow track particles.pvd --frames 100:240:2 --edge 0.005 --metrics 0\n"
                       "  kappaflow track 'level_set/phi_*.vti' --out out/tracked\n"
                       "  kappaflow track --resume out/tracked"));
}

void add_check(CLI::App& app, CommandLine& line) {
  CLI::App* check = app.add_subcommand("check", "Check a scene and say what it will cost");
  check->add_option("SCENE", line.check_scene, "Scene file (.toml)")->required();
  add_threads(*check, line.threads);
  check->footer(footer("kappaflow check scenes/staircase.toml"));
}

void add_benchmark(CLI::App& app, CommandLine& line) {
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
  add_shares(*benchmark, line.shares);
  benchmark->add_option("--out", line.benchmark.csv, "The table as CSV too");
  benchmark->footer(
      footer("kappaflow benchmark scenes/staircase.toml --particles 10000,100000 --threads 1,2"));
}

void add_probe(CLI::App& app, CommandLine& line) {
  CLI::App* probe =
      app.add_subcommand("probe", "Print field, derivatives, curvatures and velocities at points, as CSV");
  probe
      ->add_option(
          "PARTICLES", line.probe.particles,
          "Particles: .vtp with arrays velocity, weight, sigma, or .csv with x,y,z,vx,vy,vz,weight,sigma")
      ->required();
  probe->add_option("POINTS", line.probe.points, "Points: .csv with x,y,z")->required();
  probe->add_option("--threshold", line.probe.threshold, "T of Eq. 12; that of a run is in its run.json")
      ->required()
      ->check(number_in("a number", [](double) { return true; }));
  add_kernels(*probe, line.probe.kernels);
  std::vector<std::string_view> names;
  for (const VelocityMethod& method : velocity_methods()) names.push_back(method.name);
  line.probe.methods.assign(names.begin(), names.end());
  add_methods(*probe, "--methods", line.probe.methods, "Velocity methods to evaluate (default: all)", names);
  probe->footer(
      velocity_method_lines() + "\n" +
      footer("kappaflow probe out/staircase/particles/particles_0010.vtp points.csv --threshold 4.96 "
             "--methods total,curvature"));
}

std::array<int, 2> panel_size(const std::vector<double>& pixels) {
  constexpr double kLeast = 100, kMost = 8000;
  std::array<int, 2> size{};
  for (std::size_t a = 0; a < 2; ++a) {
    if (!(pixels[a] >= kLeast) || !(pixels[a] <= kMost) || pixels[a] != std::floor(pixels[a]))
      throw CLI::ValidationError(
          "--size", fmt::format("found {}; expected whole numbers from {} to {}", pixels[a], kLeast, kMost));
    size[a] = static_cast<int>(pixels[a]);
  }
  return size;
}

FrameSpan frame_span(std::string_view word) {
  const std::size_t colon = std::min(word.find(':'), word.size() - 1);
  const auto first = parse_number<int>(word.substr(0, colon)),
             last = parse_number<int>(word.substr(colon + 1));
  if (!first || !last || *first < 0 || *first > *last)
    throw CLI::ValidationError(
        "--frames", fmt::format("found \"{}\"; expected A:B, the numbers of a first and a last frame", word));
  return {*first, *last};
}

void add_render(CLI::App& app, CommandLine& line) {
  CLI::App* render = app.add_subcommand("render", "Draw the surfaces of a run side by side");
  render->add_option("DIR", line.render.folder, "Run folder")->required();
  render->add_option(
      "--out", line.render.out,
      "Picture (.png) or film (.mp4, .gif, .webp, by ffmpeg) (default: film.mp4 in the run folder)");
  render->add_option("--frame", line.render.frame, "Frame of a picture (default: the last one)")
      ->check(whole_number(0, 9999999));
  render
      ->add_option_function<std::string>(
          "--frames", [&line](const std::string& word) { line.render.frames = frame_span(word); },
          "Frames of a film, the first and the last (default: all)")
      ->type_name("A:B");
  add_positive(*render, "--fps", line.render.frames_per_second,
               "Frames a second of a film (default: as fast as the liquid moves)");
  add_methods(*render, "--methods", line.render.methods, "Methods to draw (default: those of the run)");
  render->add_option("--columns", line.render.columns, "Panels a row (default: all in one row)")
      ->check(whole_number(1, 100));
  render->add_option(
      "--colour", line.render.colour,
      "What colours the surfaces: checker, stripes, grid, an image (.png, .jpg), any point array of theirs, "
      "vectors by their length, or emission_time (default: checker; source or emission_time where liquid "
      "flows in)");
  add_numbers(
      *render, "--range", "LOW,HIGH", 2,
      [&line](const std::vector<double>& ends) {
        line.render.range = {ends[0], ends[1]};
      },
      "Values at the ends of the colour bar (default: those that 98 % of the vertices lie within)");
  render
      ->add_option_function<std::string>(
          "--fit",
          [&line](const std::string& what) { line.render.fit = what == "scene" ? Fit::scene : Fit::liquid; },
          "What fills a panel: the liquid, which a film's camera follows, or the scene (default: liquid)")
      ->type_name("NAME")
      ->check(one_of({"liquid", "scene"}));
  add_numbers(
      *render, "--size", "WIDTH,HEIGHT", 2,
      [&line](const std::vector<double>& pixels) { line.render.size = panel_size(pixels); },
      "Size of a panel in pixels (default: 900,800)");
  const auto direction = [](std::optional<Vec3>& set) {
    return [&set](const std::vector<double>& v) { set = Vec3(v.data()); };
  };
  add_numbers(*render, "--view", "X,Y,Z", 3, direction(line.render.view_from),
              "Direction from the liquid to the viewer (default: the scene's)");
  add_numbers(*render, "--up", "X,Y,Z", 3, direction(line.render.view_up),
              "What points up (default: the scene's; y for tracked files)");
  render->footer(
      footer("kappaflow render out/staircase --out picture.png --frame 40\n"
             "  kappaflow render out/staircase --methods total,regional --colour mean_curvature"));
}

void add_page(CLI::App& app, CommandLine& line) {
  CLI::App* page =
      app.add_subcommand("page", "Write a run as one HTML file to play and compare in a browser");
  page->add_option("DIR", line.page.folder, "Run folder")->required();
  page->add_option("--out", line.page.out, "Page (.html) (default: page.html in the run folder)");
  add_methods(*page, "--methods", line.page.methods, "Methods to show (default: those of the run)");
  page->footer(
      footer("kappaflow page out/staircase\n"
             "  kappaflow page out/staircase --methods total,regional --out two.html"));
}

void add_convert(CLI::App& app, CommandLine& line) {
  CLI::App* convert =
      app.add_subcommand("convert", "Write a run for Blender, Houdini and others: USD, OBJ, PLY, glTF");
  convert->add_option("DIR", line.convert.folder, "Run folder")->required();
  convert->add_option("--out", line.convert.out, "Folder for the files (default: the run folder)");
  add_formats(*convert, line.convert.formats, false);
  add_methods(*convert, "--methods", line.convert.methods, "Methods to write (default: those of the run)");
  add_numbers(
      *convert, "--up", "X,Y,Z", 3,
      [&line](const std::vector<double>& v) { line.convert.up = Vec3(v.data()); },
      "What points up, for USD and glTF (default: the scene's; y for tracked files)");
  convert->footer(
      footer("kappaflow convert out/staircase\n"
             "  kappaflow convert out/tracked --format usd,obj --methods regional --up 0,0,1 --out assets"));
}

void add_compare(CLI::App& app, CommandLine& line) {
  CLI::App* compare = app.add_subcommand("compare", "Set the metrics of runs and methods side by side");
  compare->add_option("DIR", line.compare.runs, "Run folders")->required();
  compare->add_option("--out", line.compare.folder,
                      "Folder for the table as CSV and Markdown, and a plot of each metric over time");
  compare->footer(footer("kappaflow compare out/staircase out/tracked --out out/compared"));
}

void add_experiment(CLI::App& app, CommandLine& line) {
  CLI::App* experiment = app.add_subcommand(
      "experiment", "Repeat the paper's figures, with a report of what holds and what does not");
  experiment
      ->add_option_function<std::vector<std::string>>(
          "NAMES",
          [&line](const std::vector<std::string>& words) {
            for (const std::string& word : words)
              std::ranges::move(list_elements(word), std::back_inserter(line.experiment.names));
            if (line.experiment.names.empty()) throw CLI::RequiredError("NAMES");
          },
          "Experiments, see below")
      ->required()
      ->type_name("");
  experiment->add_option("--out", line.experiment.folder, "Folder for report.html and the results")
      ->required();
  experiment->add_flag("--quick", line.experiment.quick,
                       "A smaller variant of each; the report says what is smaller");
  experiment->add_option("--scenes", line.experiment.scenes,
                         "Folder with the experiments' files (default: those that came with the program)");
  add_threads(*experiment, line.threads);
  add_force_and_quiet(*experiment, "report", line.experiment.force, line.experiment.quiet);
  experiment->footer(experiment_lines() + "\n" + footer("kappaflow experiment fig4 fig5 --out out/figures"));
}

}  // namespace kappaflow
