#include "tools/experiments/level_sets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "core/stopwatch.h"
#include "scenes/toml_reader.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/remesh/initial_mesh.h"
#include "surface/tracker/surface_methods.h"
#include "tools/experiments/enright.h"
#include "tools/experiments/enright_flow.h"
#include "tools/experiments/grid_level_set.h"
#include "tools/experiments/peers.h"
#include "tools/experiments/staircase_level_sets.h"
#include "tools/io/files.h"

namespace kappaflow {
namespace {

// Limits.
constexpr double kKeptVolume = 0.01;  // of it: a surface that has kept its volume

constexpr int kCoursePoints = 30;  // of a curve over time

// What is claimed.

const Claim kMeshesKeepVolume{
    "Brochu & Bridson 2009",
    "Level sets lose volume where the body is thin; a mesh that is tracked does not.",
    "Change of the volume at T, where the body is a sphere again."};

struct LevelSetOptions {
  std::string title;
  std::vector<double> spacings;  ///< of the grids in Enright's test [m]
  int steps = 0;
  StaircaseOptions staircase;
};

void read_enright(TomlTable& t, LevelSetOptions& options) {
  options.spacings = t.numbers("spacings", {0.002, 0.1, false, "m"}, options.spacings);
  options.steps =
      t.integer("steps", 2, 100000, options.steps > 0 ? std::optional(options.steps) : std::nullopt);
  if (options.steps % 2 != 0) t.refuse("steps", "an even number: one ends at half time");
  t.finish();
}

void read_staircase(TomlTable& t, const ExperimentContext& context, StaircaseOptions& options) {
  const std::vector<std::string_view> known = surface_method_names();
  options.scene = context.file.parent_path() / t.text("scene");
  options.methods = t.names("methods", known, options.methods);
  options.spacings = t.numbers("spacings", {0.05, 2, false, "sigma"}, options.spacings);
  options.times = t.numbers("times", positive("s"), options.times);
  t.finish();
}

LevelSetOptions read_options(const ExperimentContext& context) {
  const toml::table document = read_toml(context.file);
  LevelSetOptions options;
  TomlTable root(document, "the experiment", context.file.string());
  options.title = root.text("title");
  TomlTable enright = root.table("enright", true), staircase = root.table("staircase", true),
            quick = root.table("quick", true);
  root.finish();
  TomlTable quick_enright = quick.table("enright", true), quick_staircase = quick.table("staircase", true);
  quick.finish();
  read_enright(enright, options);
  read_staircase(staircase, context, options.staircase);
  const LevelSetOptions whole = options;
  read_enright(quick_enright, options);
  read_staircase(quick_staircase, context, options.staircase);
  return context.options.quick ? options : whole;
}

/// What there is of a surface at one time.
struct Sample {
  double volume = 0;         ///< [m3]
  double mean = 0, max = 0;  ///< distance to the exact shape, the larger of both directions [m]
};

/// A line of the table of Enright's test.
struct EnrightLine {
  std::string method, resolution;
  double start_volume = 0;
  Sample half, end;
  std::optional<VertexError> texture;  ///< at T
  double seconds = 0;
  std::vector<Vec2> course{};  ///< change of the volume over time [s]

  double lost(const Sample& sample) const { return sample.volume / start_volume - 1; }
};

Sample sample_of(const ShapeError& error, double volume) {
  return {volume, std::max(error.triangle_mean, error.shape_mean),
          std::max(error.triangle_max, error.shape_max)};
}

/// Nothing that is left is as far from the shape as nothing can tell.
Sample sample_of(const TriangleSurface& surface, const EnrightShape& shape) {
  if (surface.triangles.empty()) return {0, std::nan(""), std::nan("")};
  return sample_of(shape.error(make_triangle_mesh(surface.vertices, surface.triangles)),
                   area_and_volume(surface.vertices, surface.triangles).volume);
}

void flow(const std::vector<Vec3>& place, std::vector<Vec3>& velocity, double sign) {
  parallel_for(place.size(), [&](std::size_t i) {
    const auto u = EnrightFlow::velocity(Point<double>{place[i][0], place[i][1], place[i][2]});
    velocity[i] = sign * Vec3(u[0], u[1], u[2]);
  });
}

double change(const GridLevelSet& set, const EnrightLine& line) {
  const TriangleSurface surface = set.surface();
  return area_and_volume(surface.vertices, surface.triangles).volume / line.start_volume - 1;
}

/// The flow is steady but for a factor, so that a step through it for as long as its path is what it does.
EnrightLine line_of(LevelSetScheme scheme, double spacing, int steps, const EnrightShape& at_half,
                    const EnrightShape& at_end) {
  const TriangleMesh start = initial_mesh(EnrightField(0), spacing, {.tolerance = 1e-8});
  GridLevelSet set({start.position, start.triangles}, spacing, scheme);
  EnrightLine line;
  line.method = name_of(kLevelSetSchemes, scheme);
  line.resolution = fmt::format("{:.0f}^3", 1 / spacing);
  const TriangleSurface first = set.surface();
  line.start_volume = area_and_volume(first.vertices, first.triangles).volume;
  const double dt = EnrightFlow::kPeriod / steps;
  for (int n = 0; n < steps; ++n) {
    const double path = EnrightFlow::path((n + 1) * dt) - EnrightFlow::path(n * dt), sign = path < 0 ? -1 : 1;
    line.seconds += seconds_of([&] {
      set.advect([&](const auto& place, auto& velocity) { flow(place, velocity, sign); },
                 EnrightFlow::kLargestSpeed, std::abs(path));
    });
    if (2 * (n + 1) == steps) line.half = sample_of(set.surface(), at_half);
    if ((n + 1) % std::max(1, steps / kCoursePoints) == 0)
      line.course.emplace_back((n + 1) * dt, change(set, line));
  }
  line.end = sample_of(set.surface(), at_end);
  return line;
}

EnrightLine line_of(const EnrightResult& result, const std::string& field) {
  const auto sample = [](const EnrightSample& s) { return sample_of(s.shape, s.volume); };
  return {fmt::format("{}, {}", result.velocity, field),
          fmt::format("edge {}", result.edge_length),
          result.start_volume,
          sample(result.half),
          sample(result.end),
          result.end.vertex,
          result.seconds};
}

std::vector<EnrightLine> tracked_lines(const ExperimentContext& context) {
  ExperimentContext enright = context;
  enright.file = context.file.parent_path() / "enright.toml";
  std::vector<EnrightLine> lines;
  for (const bool on_particles : {false, true})
    for (const EnrightResult& result : remeshed_in_enright(enright, on_particles))
      lines.push_back(line_of(result, on_particles ? "on particles" : "on the exact function"));
  return lines;
}

std::string percent(double share) {
  return fmt::format("{:+.2f} %", 100 * share);
}

std::string pair_text(double mean, double max) {
  return std::isnan(mean) ? "nothing left" : fmt::format("{:.2g}, {:.2g}", mean, max);
}

/// A row of enright_programs.toml: program, triangles, volume at T/2 and T, distance, angle, time.
std::vector<std::string> program_cells(const std::vector<std::string>& cells) {
  const std::string& volume = cells[2];
  const std::size_t comma = volume.find(", ");
  return {cells[0],
          "-",
          volume.substr(0, comma),
          comma == std::string::npos ? "-" : volume.substr(comma + 2),
          "-",
          cells[3],
          "-",
          cells[5],
          "run for comparison"};
}

Table enright_table(const ExperimentContext& context, const std::vector<EnrightLine>& lines) {
  Table table = level_set_papers(context);
  std::vector<std::vector<std::string>> papers = std::exchange(table.rows, {});
  for (const std::vector<std::string>& program : enright_programs(context).rows)
    papers.push_back(program_cells(program));
  for (const EnrightLine& line : lines)
    table.rows.push_back({line.method, line.resolution, percent(line.lost(line.half)),
                          percent(line.lost(line.end)), pair_text(line.half.mean, line.half.max),
                          pair_text(line.end.mean, line.end.max),
                          line.texture ? pair_text(line.texture->mean, line.texture->max) : "-",
                          fmt::format("{:.0f} s", line.seconds), "measured here"});
  table.rows.insert(table.rows.end(), papers.begin(), papers.end());
  return table;
}

std::string enright_csv(const std::vector<EnrightLine>& lines) {
  std::string text =
      "method,resolution,volume_change_half,volume_change_end,shape_error_half_mean,shape_error_half_max,"
      "shape_error_"
      "end_mean,shape_error_end_max,texture_error_mean,texture_error_max,seconds\n";
  for (const EnrightLine& line : lines)
    text += fmt::format("\"{}\",{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{},{},{:.3g}\n", line.method,
                        line.resolution, line.lost(line.half), line.lost(line.end), line.half.mean,
                        line.half.max, line.end.mean, line.end.max,
                        line.texture ? fmt::format("{:.6g}", line.texture->mean) : "",
                        line.texture ? fmt::format("{:.6g}", line.texture->max) : "", line.seconds);
  return text;
}

/// Of the finest grids, beside the meshes at T/2 and T.
void add_plot(const std::vector<EnrightLine>& tracked, const std::vector<EnrightLine>& sets,
              const ExperimentContext& context, Report& report) {
  Plot plot{"Volume in Enright's test", "t [s]", "change of the volume", {}};
  for (const EnrightLine& line : tracked)
    plot.curves.push_back({line.method,
                           {Vec2(0, 0), Vec2(EnrightFlow::kPeriod / 2, line.lost(line.half)),
                            Vec2(EnrightFlow::kPeriod, line.lost(line.end))}});
  for (const EnrightLine& line : sets)
    if (line.resolution == sets.back().resolution) plot.curves.push_back({line.method, line.course});
  add_plots(report, context, "volume", {&plot, 1},
            fmt::format("What becomes of the volume, on grids of {}.", sets.back().resolution));
}

void judge(const std::vector<EnrightLine>& tracked, const std::vector<EnrightLine>& sets, Report& report) {
  std::vector<Check> checks;
  checks.reserve(tracked.size() + sets.size());
  for (const EnrightLine& line : tracked)
    checks.push_back(at_most(line.method, std::abs(line.lost(line.end)), kKeptVolume));
  for (const EnrightLine& line : sets)
    checks.push_back(
        at_least(fmt::format("{}, {}", line.method, line.resolution), -line.lost(line.end), kKeptVolume));
  report.statements = {judged(kMeshesKeepVolume, checks)};
}

}  // namespace

Report experiment_level_sets(const ExperimentContext& context) {
  require_openvdb();
  const LevelSetOptions options = read_options(context);
  const double resolution = context.options.quick ? kQuickEnrightResolution : kEnrightResolution;
  const EnrightShape at_half(EnrightFlow::kPeriod / 2, resolution), at_end(EnrightFlow::kPeriod, resolution);
  std::vector<EnrightLine> sets;
  for (const double spacing : options.spacings)
    for (const auto& [name, scheme] : kLevelSetSchemes) {
      context.say(fmt::format("Enright's test, {}, {} m", name, spacing));
      sets.push_back(line_of(scheme, spacing, options.steps, at_half, at_end));
    }
  const std::vector<EnrightLine> tracked = tracked_lines(context);
  Report report;
  report.name = context.name;
  report.title = options.title;
  report.introduction = fmt::format(
      "Level sets by OpenVDB beside tracked meshes: on Enright's test, in {} steps, and on the staircase in "
      "the "
      "velocity of its particles. A level set knows no material: it has no texture.",
      options.steps);
  judge(tracked, sets, report);
  add_plot(tracked, sets, context, report);
  std::vector<EnrightLine> lines = tracked;
  lines.insert(lines.end(), sets.begin(), sets.end());
  write_file(context.folder / "enright.csv", enright_csv(lines));
  report.files = {"enright.csv"};
  report.tables = {enright_table(context, lines), staircase_table(context, options.staircase)};
  return report;
}

}  // namespace kappaflow
