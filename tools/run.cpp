#include "tools/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>

#include "scenes/wall_distance.h"
#include "tools/data_files.h"
#include "tools/metrics.h"
#include "tools/progress.h"
#include "tools/run_folder.h"
#include "tools/run_record.h"
#include "tools/simulation.h"
#include "tools/summary.h"

namespace kappaflow {
namespace {

volatile std::sig_atomic_t interrupted = 0;

// Installs the handler for as long as it lives; a second Ctrl-C ends the program at once.
class InterruptGuard {
 public:
  InterruptGuard() {
    interrupted = 0;
    previous_ = std::signal(SIGINT, [](int) {
      interrupted = 1;
      std::signal(SIGINT, SIG_DFL);
    });
  }
  ~InterruptGuard() { std::signal(SIGINT, previous_); }
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  void (*previous_)(int);
};

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

// Measures and writes frames; keeps what is the same in all of them.
class FrameWriter {
 public:
  FrameWriter(const Scene& scene, const Simulation& simulation, RunFolder& folder)
      : scene_(scene),
        simulation_(simulation),
        folder_(folder),
        motions_(wall_motions(scene)),
        walls_(simulation.walls()) {
    if (motions_.empty() && !simulation.walls().empty())
      folder.write_boundary(*boundary_data(simulation.walls()));
    const TriangleMesh& mesh = simulation.trackers().front().mesh();
    initial_vertices_ = mesh.vertex_count();
    initial_box_ = bounding_box(mesh.rest_position);
    last_frame_.assign(simulation.trackers().size(), {mesh.next_id, mesh.vertex_count()});
  }

  void write(int frame, double time, SinceFrame since_frame, RunSummary& summary) {
    const Stopwatch shared_watch;
    if (!motions_.empty()) move_walls(frame, time);
    const FrameMetrics frame_metrics = measure_frame(frame, time, since_frame);
    write_particles(frame);
    const double shared_seconds = shared_watch.seconds();

    FrameRows rows;
    summary.methods.resize(simulation_.trackers().size());
    for (std::size_t m = 0; m < simulation_.trackers().size(); ++m) {
      const Stopwatch watch;
      const std::string method(simulation_.trackers()[m].method().name);
      const SurfaceMetrics metrics = write_surface(frame_metrics, m, since_frame);
      since_frame.seconds[m].output = shared_seconds + watch.seconds();
      rows.metrics += metrics_row(frame_metrics, method, metrics);
      rows.pieces += pieces_rows(frame_metrics, method, metrics);
      rows.timings += timings_row(frame, time, method, since_frame.seconds[m]);
      summary.methods[m].add_frame(method, metrics, since_frame.seconds[m]);
    }
    folder_.finish_frame(time, rows);
    summary.add_frame(frame_metrics, since_frame.tracer_seconds, shared_seconds);
  }

 private:
  FrameMetrics measure_frame(int frame, double time, const SinceFrame& since_frame) const {
    FrameMetrics metrics;
    metrics.frame = frame;
    metrics.time = time;
    metrics.particles = simulation_.particles().size();
    metrics.penetration_max = penetration_max(simulation_.particles().position, walls_, scene_.fluid.spacing);
    const Compression now = compression(simulation_.fluid().densities(), scene_.fluid.density);
    metrics.density_error_mean = std::max(now.mean, since_frame.density_error_mean);
    metrics.density_error_max = std::max(now.max, since_frame.density_error_max);
    measure_isosurface(simulation_.field(), simulation_.field_options().sigma, metrics);
    return metrics;
  }

  void move_walls(int frame, double time) {
    const std::vector<TriangleSurface> walls = walls_at(time, simulation_.walls(), motions_);
    walls_ = WallDistance(walls);
    folder_.write_boundary(frame, *boundary_data(walls));
  }

  void write_particles(int frame) {
    const Particles& particles = simulation_.particles();
    const ParticleFieldOptions& options = simulation_.field_options();
    const std::vector<float> density = simulation_.fluid().densities(),
                             pressure = simulation_.fluid().pressures();
    const std::vector<double> weight = field_weights(particles.position, options.sigma, options.weights);
    folder_.write_particles(frame, *particle_data({particles, density, pressure, weight, options.sigma}));
  }

  SurfaceMetrics write_surface(const FrameMetrics& frame, std::size_t m, const SinceFrame& since_frame) {
    const SurfaceTracker& tracker = simulation_.trackers()[m];
    const TriangleMesh& mesh = tracker.mesh();
    const SurfaceState state = surface_state(simulation_.field(), mesh, tracker.rings(), tracker.method(),
                                             tracker.options().velocity);
    const double sigma = simulation_.field_options().sigma;
    folder_.write_surface(
        frame.frame, std::string(tracker.method().name),
        *surface_data({frame.time, mesh, state,
                       checker_colours(mesh.rest_position, scene_.output.checker_size * sigma),
                       texture_coordinates(mesh.rest_position, initial_box_, scene_.output.texture)}));

    SurfaceMetrics metrics =
        surface_metrics(simulation_.field(), frame, mesh, tracker.rings(), state, scene_.output.report_axis);
    metrics.residual_max = std::max(metrics.residual_max, since_frame.residual_max[m]);
    metrics.regions_replaced = since_frame.topology[m].replaced;
    metrics.regions_refused = since_frame.topology[m].refused;
    metrics.tracer_distance = tracer_distance(mesh, simulation_.tracers(), sigma);
    metrics.kept_fraction =
        kept_share(mesh, {static_cast<std::int64_t>(initial_vertices_), initial_vertices_});
    metrics.kept_since_frame = kept_share(mesh, last_frame_[m]);
    last_frame_[m] = {mesh.next_id, mesh.vertex_count()};
    return metrics;
  }

  /// A mesh at an earlier time: ids below next_id, and how many vertices it had.
  struct Earlier {
    std::int64_t next_id = 0;
    std::size_t vertices = 0;
  };
  /// The share of its vertices that the mesh still has.
  static double kept_share(const TriangleMesh& mesh, const Earlier& earlier) {
    if (earlier.vertices == 0) return 1;
    return static_cast<double>(vertices_older_than(mesh, earlier.next_id)) /
           static_cast<double>(earlier.vertices);
  }

  const Scene& scene_;
  const Simulation& simulation_;
  RunFolder& folder_;
  std::vector<BodyMotion> motions_;
  WallDistance walls_;  // where they are in the frame
  std::size_t initial_vertices_ = 0;
  Bounds initial_box_;               // of the first mesh
  std::vector<Earlier> last_frame_;  // the meshes at the last frame, one entry a method
};

}  // namespace

RunSummary run_scene(const RunOptions& options) {
  const InterruptGuard interrupt_guard;
  const Stopwatch watch;
  const Scene scene = load_scene_for(options);
  if (scene.surface.methods.empty())
    throw InvalidInput(
        fmt::format("{}: no velocity method to track with; name one in [surface] methods or by "
                    "--track, \"material\" where only the liquid matters",
                    scene.file.string()));
  RunFolder folder(folder_for(options), scene.surface.methods, options.force);
  Simulation simulation(scene);
  folder.write_record(run_record(options, scene, simulation));

  const FrameTimes times(scene);
  FrameWriter writer(scene, simulation, folder);
  RunSummary summary;
  summary.setup_seconds = watch.seconds();
  writer.write(0, 0, simulation.take_since_frame(), summary);
  {
    Progress progress(scene.duration, times.count, !options.quiet);
    for (int frame = 1; frame <= times.count; ++frame) {
      const bool arrived = simulation.advance(times[frame], [&](const FluidStep& step) {
        progress.show(simulation.fluid().time(), frame, step);
        return !interrupted;
      });
      if (arrived) writer.write(frame, times[frame], simulation.take_since_frame(), summary);
      if (interrupted) break;
    }
  }
  summary.steps = simulation.steps();
  summary.wall_seconds = watch.seconds();
  summary.interrupted = interrupted != 0;
  summary.interrupted_at = simulation.fluid().time();
  summary.text = summary_text(summary, scene, simulation.field_options(), folder.path());
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
