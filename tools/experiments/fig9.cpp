#include "tools/experiments/fig9.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surface/tracker/surface_methods.h"
#include "tools/pictures/method_curve.h"
#include "tools/pictures/render.h"
#include "tools/runs/run.h"

namespace kappaflow {
namespace {

// Limits.
constexpr double kRotationOff = 0.2;                         // of the material's; Eq. 10 follows within it
constexpr double kRegionalSlipShare = 0.25;                  // regional's slip over total's and over Eq. 10's
constexpr double kLeastCaptured = 0.9, kMostCaptured = 1.1;  // of the material's rotation, by regional
constexpr double kDistanceShare = 1.0 / 3;                   // regional's tracer distance over Eq. 10's
constexpr double kPlottedRotation =
    3;  // more is of frames in which the material hardly turns, and sets the scale

// What is claimed.

const Claim kFollowsRolling{
    "Fujisawa et al. 2011, Fig. 9",
    "Curvature invariance follows the rolling of the liquid, total velocity does not.",
    "Total velocity keeps normals, which a rolling body does not."};
const Claim kSlipsLess{"Fujisawa et al. 2011, Fig. 9",
                       "Curvature invariance moves the surface with the liquid better than total velocity.",
                       "0 is perfect, 1 is no better than not moving along the surface at all."};
const Claim kRegionalSlipsLess{
    "kappaflow", "The regional velocity slips at most a quarter as much as total and as Eq. 10.",
    "It knows how the field answers a strain of the material, and asks a neighbourhood."};
const Claim kRegionalRolls{"kappaflow", "The regional velocity captures 0.9 to 1.1 of the rotation.",
                           "See above."};
const Claim kRegionalStaysNear{
    "kappaflow",
    "At the end the regional velocity's vertices are at most a third as far from their material as Eq. 10's.",
    "Fairing that holds confident vertices helps Eq. 10 more than it helps the regional velocity; with the "
    "paper's "
    "fairing, which moves every vertex, both drift further, Eq. 10 by more."};

RunSummary run_all_methods(const ExperimentContext& context) {
  RunOptions options;
  options.scene = context.file;
  options.folder = context.folder / "run";
  for (const std::string_view method : surface_method_names()) options.methods.emplace_back(method);
  options.keep_connectivity = true;  // as the paper's mesh
  options.threads = context.options.threads;
  options.force = true;  // the experiments' folder was checked already
  options.quiet = context.options.quiet;
  options.command = {"kappaflow", "experiment", context.name};
  return run_scene(options);
}

/// The number of frames from the start on in which the mesh is sound.
std::size_t sound_frames(const RunSummary& run, const MethodSummary& method) {
  std::size_t n = 0;
  while (n < run.frames.size() && method.frames[n].sound(run.frames[n].isosurface.value())) ++n;
  return n;
}

std::string text(const std::optional<double>& value) {
  return value ? fmt::format("{:.3f}", *value) : "-";
}

std::optional<double> median_of(std::span<const SurfaceMetrics> frames,
                                std::optional<double> SurfaceMetrics::*member) {
  return median_over(frames, member);
}

Table method_table(const RunSummary& run) {
  Table table{
      fmt::format(
          "Medians over the frames until the mesh is no longer sound, and over the whole run in parentheses. "
          "A mesh is sound while every vertex is on the surface, at most {} % of the triangles have folded "
          "over, its volume is within {} % of a fresh isosurface's, and components and genus are the same as "
          "there. Slip: RMS tangential difference to the material velocity over the RMS tangential material "
          "speed. Rotation: about the scene's axis, of the largest piece's least-squares rigid motion over "
          "the material's (pieces.csv has every piece). Tracer distance: from a vertex to the material that "
          "it started on, in sigma, when the mesh stops being sound and at the end. Texture distance: of the "
          "rest position from where the material began, at the end, for meshes that are new in every frame "
          "too. Time a frame: of the surface alone, median.",
          100 * kSoundFolded, 100 * kSoundVolume),
      {"method", "sound until [s]", "slip", "rotation captured", "tracer distance", "texture distance",
       "quality, mean at end", "folded at end", "volume at end", "time a frame [s]"},
      {}};
  for (const MethodSummary& method : run.methods) {
    const std::size_t n = sound_frames(run, method);
    const std::span<const SurfaceMetrics> all = method.frames, sound = all.first(n);
    const SurfaceMetrics& last = all.back();
    const auto both = [&](std::optional<double> SurfaceMetrics::*member) {
      return fmt::format("{} ({})", text(median_of(sound, member)), text(median_of(all, member)));
    };
    table.rows.push_back(
        {method.name, n == 0 ? "never" : fmt::format("{:.2f}", run.frames[n - 1].time),
         both(&SurfaceMetrics::slip), both(&SurfaceMetrics::rotation_captured),
         fmt::format("{}, {}", n == 0 ? "-" : text(all[n - 1].tracer_distance), text(last.tracer_distance)),
         text(last.texture_distance), fmt::format("{:.3f}", last.quality.mean),
         fmt::format("{:.2f} %", 100 * last.folded_fraction),
         fmt::format("{:+.2f} %", 100 * (last.size.volume / run.frames.back().isosurface.value().volume - 1)),
         text(method.time_a_frame())});
  }
  return table;
}

/// Of the methods that have such a value: fresh meshes have no motion.
Plot plot_over_time(const RunSummary& run, const std::string& title, const std::string& label,
                    const std::function<double(const SurfaceMetrics&)>& value) {
  Plot plot{title, "t [s]", label, {}};
  for (const MethodSummary& method : run.methods) {
    Curve curve = method_curve(method.name);
    for (std::size_t f = 0; f < run.frames.size(); ++f)
      curve.points.emplace_back(run.frames[f].time, value(method.frames[f]));
    const auto known = [](const Vec2& point) { return !std::isnan(point.y()); };
    if (std::ranges::any_of(curve.points, known)) plot.curves.push_back(std::move(curve));
  }
  return plot;
}

void add_plots(const RunSummary& run, const ExperimentContext& context, Report& report) {
  const auto number = [](const std::optional<double>& value) { return value.value_or(std::nan("")); };
  const std::vector<Plot> motion{
      plot_over_time(run, "Slip against the material", "slip",
                     [&](const SurfaceMetrics& m) { return number(m.slip); }),
      plot_over_time(run, "Rotation captured", "of the material's rotation", [&](const SurfaceMetrics& m) {
        const double captured = number(m.rotation_captured);
        return std::abs(captured) < kPlottedRotation ? captured : std::nan("");
      })};
  add_plots(report, context, "fig9-motion", motion,
            "How well each surface follows the material, frame by frame.");
  const std::vector<Plot> mesh{
      plot_over_time(run, "Distance to material tracers", "mean distance [sigma]",
                     [&](const SurfaceMetrics& m) { return number(m.tracer_distance); }),
      plot_over_time(run, "Triangle quality", "mean of 2 inradius/circumradius",
                     [](const SurfaceMetrics& m) { return m.quality.mean; })};
  add_plots(report, context, "fig9-mesh", mesh,
            "How far vertices are from their material, and what becomes of the mesh.");
}

void add_pictures(const RunSummary& run, const ExperimentContext& context, Report& report) {
  const int last = static_cast<int>(run.frames.size()) - 1;
  for (const int frame : {last / 3, 2 * last / 3, last}) {
    context.say(fmt::format("drawing frame {}", frame));
    const std::string name = fmt::format("fig9_{:04}.png", frame);
    RenderOptions options;
    options.folder = context.folder / "run";
    options.out = context.folder / name;
    options.frame = frame;
    options.columns = 3;
    options.size = {640, 560};  // more is not seen of three on a page, and takes its time
    render(options);
    report.figures.push_back({name, fmt::format("All methods at t = {:.2f} s.", run.frames[frame].time)});
  }
}

/// One method over the whole run: medians over its frames, and the distance at the end [sigma].
struct Followed {
  double slip, rotation, distance;
};

Followed followed(const RunSummary& run, std::string_view name) {
  const MethodSummary& method = *std::ranges::find(run.methods, name, &MethodSummary::name);
  const double nan = std::nan("");
  return {median_of(method.frames, &SurfaceMetrics::slip).value_or(nan),
          median_of(method.frames, &SurfaceMetrics::rotation_captured).value_or(nan),
          method.frames.back().tracer_distance.value_or(nan)};
}

Table beside_fig9(const RunSummary& run, const Followed& total, const Followed& curvature) {
  const auto medians = [](const Followed& f) {
    return fmt::format("{:.2f} of the rotation, slip {:.2f} (medians)", f.rotation, f.slip);
  };
  return beside_paper(
      "Fig. 9", {{"liquid", "viscous, simulated with SPH; slides and rolls down a staircase",
                  fmt::format("the same, {} particles, {:.3g} s", run.frames.front().particles,
                              run.frames.back().time)},
                 {"methods", "total velocity and curvature invariance (Eq. 10)", "these and eight others"},
                 {"curvature invariance", "follows the rolling of the liquid", medians(curvature)},
                 {"total velocity", "does not", medians(total)},
                 {"shown by", "pictures", "pictures, and these numbers"}});
}

void judge(const RunSummary& run, Report& report) {
  const Followed total = followed(run, "total"), curvature = followed(run, "curvature"),
                 regional = followed(run, "regional");
  report.statements = {
      judged(kFollowsRolling, {{.what = "curvature (Eq. 10): rotation captured, median",
                                .value = curvature.rotation,
                                .low = 1 - kRotationOff,
                                .high = 1 + kRotationOff},
                               at_least("total: how far that is off 1", std::abs(total.rotation - 1),
                                        std::abs(curvature.rotation - 1), "curvature's")}),
      judged(kSlipsLess,
             {at_most("slip of curvature (Eq. 10), median", curvature.slip, total.slip, "total's")}),
      judged(kRegionalSlipsLess, {at_most("against total", regional.slip, kRegionalSlipShare * total.slip,
                                          "a quarter of its slip"),
                                  at_most("against Eq. 10", regional.slip,
                                          kRegionalSlipShare * curvature.slip, "a quarter of its slip")}),
      judged(kRegionalRolls,
             {{.what = "", .value = regional.rotation, .low = kLeastCaptured, .high = kMostCaptured}}),
      judged(kRegionalStaysNear, {at_most("mean distance [sigma]", regional.distance,
                                          kDistanceShare * curvature.distance, "a third of Eq. 10's")})};
  report.beside = beside_fig9(run, total, curvature);
}

}  // namespace

Report experiment_fig9(const ExperimentContext& context) {
  Report report;
  report.name = context.name;
  const RunSummary run = run_all_methods(context);
  report.title = "A viscous ball slides and rolls down a staircase";
  report.introduction = fmt::format(
      "`{}`, {} particles, {} frames to t = {:.3g} s; every method on the same particles and from the same "
      "mesh. The mesh keeps its connectivity throughout, so each method is judged up to the time to which "
      "its mesh stays sound.",
      context.file.filename().string(), run.frames.front().particles, run.frames.size(),
      run.frames.back().time);
  if (context.options.quick) add_smaller(report, "scene", context.file.filename().string(), "staircase.toml");
  judge(run, report);
  add_pictures(run, context, report);
  add_plots(run, context, report);
  report.tables.push_back(method_table(run));
  report.files = {"run/metrics.csv", "run/pieces.csv", "run/run.pvd"};
  return report;
}

}  // namespace kappaflow
