#include "tools/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/wall_distance.h"
#include "tools/check.h"
#include "tools/data_files.h"
#include "tools/frame_writer.h"
#include "tools/metrics.h"
#include "tools/progress.h"
#include "tools/run_folder.h"
#include "tools/run_record.h"
#include "tools/simulation.h"
#include "tools/summary.h"

namespace kappaflow {
namespace {

Scene load_scene_for(const RunOptions& options) {
  Scene scene = load_scene(options.scene);
  if (options.duration) scene.duration = *options.duration;
  if (options.minimiser) scene.surface.tracker.velocity.minimiser = *options.minimiser;
  if (options.keep_connectivity) scene.surface.remesh = false;
  if (!options.methods.empty()) scene.surface.methods = options.methods;
  return scene;
}

std::filesystem::path folder_for(const RunOptions& options) {
  return options.folder.empty() ? std::filesystem::path("out") / options.scene.stem() : options.folder;
}

// Frame 0 is the start; the last one falls on the duration even where that is no multiple of the frame time.
struct FrameTimes {
  explicit FrameTimes(const Scene& scene)
      : count(static_cast<int>(std::ceil(scene.duration * scene.output.frames_per_second - 1e-9))),
        frames_per_second(scene.output.frames_per_second),
        duration(scene.duration) {}
  double operator[](int frame) const { return std::min(frame / frames_per_second, duration); }

  int count;  ///< number of the last frame
  double frames_per_second, duration;
};

std::string solver_iterations(const FluidStep& step) {
  return fmt::format("pressure {}, viscosity {}", step.density_iterations + step.divergence_iterations,
                     step.viscosity_iterations);
}

// Measures the liquid and its walls at each frame, and has the surfaces written beside them.
class RunWriter {
 public:
  RunWriter(const Scene& scene, const Simulation& simulation, const std::vector<MeshFormat>& formats,
            RunFolder& folder)
      : scene_(scene),
        simulation_(simulation),
        folder_(folder),
        motions_(wall_motions(scene)),
        walls_(simulation.walls()),
        writer_(scene.output, simulation.surfaces(), formats, folder) {
    if (motions_.empty() && !simulation.walls().empty())
      folder.write_boundary(*boundary_data(simulation.walls()));
  }

  void write(int frame, double time, const SinceFrame& since_frame, RunSummary& summary) {
    const Stopwatch watch;
    if (!motions_.empty()) move_walls(frame, time);
    const Particles& particles = simulation_.particles();
    const ParticleFieldOptions& options = simulation_.surfaces().field_options();
    const std::vector<float> density = simulation_.fluid().densities(),
                             pressure = simulation_.fluid().pressures();
    const std::vector<double> weight = field_weights(particles.position, options.sigma, options.weights);
    writer_.write(liquid_metrics(frame, time, density, since_frame),
                  {particles, density, pressure, weight, options.sigma}, since_frame.surfaces, watch,
                  summary);
  }

 private:
  FrameMetrics liquid_metrics(int frame, double time, std::span<const float> density,
                              const SinceFrame& since_frame) const {
    FrameMetrics metrics;
    metrics.frame = frame;
    metrics.time = time;
    metrics.penetration_max = penetration_max(simulation_.particles().position, walls_, scene_.fluid.spacing);
    const Compression now = compression(density, scene_.fluid.density);
    metrics.density_error_mean = std::max(now.mean, since_frame.density_error_mean);
    metrics.density_error_max = std::max(now.max, since_frame.density_error_max);
    return metrics;
  }

  void move_walls(int frame, double time) {
    const std::vector<TriangleSurface> walls = walls_at(time, simulation_.walls(), motions_);
    walls_ = WallDistance(walls);
    folder_.write_boundary(frame, *boundary_data(walls));
  }

  const Scene& scene_;
  const Simulation& simulation_;
  RunFolder& folder_;
  std::vector<BodyMotion> motions_;
  WallDistance walls_;  // where they are in the frame
  FrameWriter writer_;
};

}  // namespace

RunSummary run_scene(const RunOptions& options) {
  const InterruptGuard guard;
  const Stopwatch watch;
  const Scene scene = load_scene_for(options);
  if (scene.surface.methods.empty())
    throw InvalidInput(
        fmt::format("{}: no velocity method to track with; name one in [surface] methods or by "
                    "--track, \"material\" where only the liquid matters",
                    scene.file.string()));
  require_memory(scene, machine_memory());
  RunFolder folder(folder_for(options), scene.surface.methods, options.force);
  Simulation simulation(scene);
  folder.write_record(run_record(options, scene, simulation));

  const FrameTimes times(scene);
  RunWriter writer(scene, simulation, options.formats, folder);
  RunSummary summary;
  summary.setup_seconds = watch.seconds();
  writer.write(0, 0, simulation.take_since_frame(), summary);
  {
    Progress progress(0, scene.duration, times.count, !options.quiet);
    for (int frame = 1; frame <= times.count; ++frame) {
      const bool arrived = simulation.advance(times[frame], [&](const FluidStep& step) {
        progress.show(simulation.fluid().time(), frame, solver_iterations(step));
        return !guard.interrupted();
      });
      if (arrived) writer.write(frame, times[frame], simulation.take_since_frame(), summary);
      if (guard.interrupted()) break;
    }
  }
  summary.steps = simulation.steps();
  summary.wall_seconds = watch.seconds();
  summary.interrupted = guard.interrupted();
  summary.interrupted_at = simulation.fluid().time();
  summary.text = summary_text(summary, scene.title, simulation.surfaces().field_options(), folder.path());
  return summary;
}

int run(const RunOptions& options) {
  const RunSummary summary = run_scene(options);
  if (!options.quiet) fmt::print("{}", summary.text);
  if (!summary.interrupted) return 0;
  fmt::print(stderr, "kappaflow: interrupted at t = {:.6g} s; {} frames are complete\n",
             summary.interrupted_at, summary.frames.size());
  return kExitInterrupted;
}

}  // namespace kappaflow
