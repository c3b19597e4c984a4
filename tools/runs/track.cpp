#include "tools/runs/track.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "core/errors.h"
#include "surface/measure/surface_motion.h"
#include "surface/motion/velocity_methods.h"
#include "tools/runs/frame_writer.h"
#include "tools/runs/interrupt.h"
#include "tools/runs/progress.h"
#include "tools/runs/run_record.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr double kCheckerSize = 2;  // in sigma

/// Everything that follows from the options and the first frame.
struct TrackSetup {
  SurfaceDescription surface;
  ParticleFieldOptions field;
  double spacing = 0;  // measured [m]; 0 where sigma is given
};

/// Throws InvalidInput where there is no spacing, with the file and what to do.
double measured_spacing(const ParticleSequence& sequence, const Particles& first) {
  constexpr const char* kAdvice = "say the radius of a particle's field by --sigma";
  const SourcePosition file{sequence.file(0).string()};
  if (first.size() < 2)
    throw InvalidInput(file, fmt::format("holds one particle, which has no spacing; {}", kAdvice));
  try {
    return particle_spacing(first.position);
  } catch (const InvalidInput&) {
    const Coincidence found = coincident_particles(first.position);
    throw InvalidInput(
        file,
        fmt::format("{} of {} particles are where others are, e.g. {} and {}, and have no spacing; keep one "
                    "in a place, or {}",
                    found.count, first.size(), first.id[found.first], first.id[found.second], kAdvice));
  }
}

TrackSetup make_setup(const TrackOptions& options, const ParticleSequence& sequence, const Particles& first) {
  TrackSetup setup;
  SurfaceDescription& surface = setup.surface;
  if (options.sigma)
    surface.sigma = *options.sigma;
  else
    setup.spacing = measured_spacing(sequence, first);
  surface.threshold = options.threshold;
  surface.weights = options.weights;
  const bool is_cloud = sequence.velocity() == ParticleSequence::Velocity::unknown;
  surface.methods = options.methods;
  if (surface.methods.empty()) surface.methods = {is_cloud ? "regional" : "material"};
  if (is_cloud && std::ranges::count(surface.methods, "material") > 0)
    throw InvalidInput(fmt::format(
        "{}: the velocity \"material\" takes particles with velocities or ids; these have neither",
        sequence.name()));
  surface.spacing = options.sigma ? 1 : setup.spacing;
  surface.is_cloud = is_cloud;
  surface.velocities = velocity_functions(surface.methods);
  surface.name = sequence.name();
  setup.field = field_options(surface, first.position);
  return setup;
}

fs::path folder_for(const TrackOptions& options, const ParticleSequence& sequence) {
  return options.folder.empty() ? fs::path("out") / sequence.name() : options.folder;
}

/// Throws InvalidInput where a point cloud's surface moves too far between two frames.
void check_cloud_motion(ParticleSequence& sequence, const ParticleFieldOptions& field) {
  auto before = particle_field(sequence.frame(0).particles, field);
  for (std::size_t k = 1; k < sequence.size(); ++k) {
    auto after = particle_field(sequence.frame(k).particles, field);
    const double motion = surface_motion(*before, *after, field.sigma);
    if (motion > kLargestCloudMotion)
      throw InvalidInput(
          {sequence.file(k).string()},
          fmt::format("the surface moves {:.2f} sigma since the frame before; without ids or "
                      "velocities it can be followed up to {} sigma a frame: write frames more "
                      "often, or ids, or set a larger --sigma",
                      motion, kLargestCloudMotion));
    before = std::move(after);
  }
}

std::string setup_text(const ParticleSequence& sequence, const TrackSetup& setup,
                       const TrackOptions& options) {
  std::string text = fmt::format("{}: {} files, {} ... {}\n", sequence.name(), sequence.size(),
                                 sequence.file(0).string(), sequence.file(sequence.size() - 1).string());
  for (const std::string& note : sequence.notes()) text += fmt::format("  {}\n", note);
  const std::string sigma = options.sigma
                                ? fmt::format("sigma {:.6g} m (given)", setup.field.sigma)
                                : fmt::format("spacing {:.6g} m (measured), sigma {:.6g} m ({} spacings)",
                                              setup.spacing, setup.field.sigma, setup.surface.sigma);
  return text + fmt::format("  {}, threshold {:.6g} ({})\n  velocity {}\n", sigma, setup.field.threshold,
                            options.threshold ? "given" : "half the field's median at the particles",
                            fmt::join(setup.surface.methods, ", "));
}

void write_frame(FrameWriter& writer, RunFolder& folder, int number, const SequenceFrame& frame,
                 TrackedSurfaces& surfaces, double tracer_seconds, RunSummary& summary) {
  const Stopwatch watch;
  surfaces.find_sources(frame.source);
  const ParticleFieldOptions& field = surfaces.field_options();
  const std::vector<double> weight = field_weights(frame.particles.position, field.sigma, field.weights);
  FrameMetrics metrics;
  metrics.frame = number;
  metrics.time = frame.particles.time;
  writer.write(metrics, {frame.particles, frame.density, frame.pressure, frame.source, weight, field.sigma},
               {surfaces.take_report(), tracer_seconds}, watch, summary);
  folder.flush();
}

RunSummary track_sequence(const TrackOptions& options, ParticleSequence& sequence, const TrackSetup& setup,
                          const InterruptGuard& guard) {
  const SequenceFrame first = sequence.frame(0);
  TrackedSurfaces surfaces(first.particles, sequence.frame(1).particles, setup.surface);
  MaterialTracers tracers(surfaces.mesh().position);

  RunFolder folder(folder_for(options, sequence), setup.surface.methods, options.force);
  folder.write_record(track_record(options, sequence, setup.surface, setup.field));
  if (!options.quiet) fmt::print("{}", setup_text(sequence, setup, options));
  std::fflush(stdout);
  OutputDescription output;
  output.checker_size = kCheckerSize;
  FrameWriter writer(output, setup.surface.methods, surfaces, tracers, options.formats, folder);
  RunSummary summary;
  write_frame(writer, folder, 0, first, surfaces, 0, summary);
  folder.take_place();
  const int last = static_cast<int>(sequence.size()) - 1;
  Progress progress(sequence.time(0), sequence.time(last), last, !options.quiet);
  for (int k = 1; k <= last && !guard.interrupted(); ++k) {
    const SequenceFrame next = sequence.frame(k);
    const int steps = surfaces.steps_to(next.particles);
    double tracer_seconds = 0;
    const bool arrived = surfaces.step(next.particles, [&](FieldMotion& step) {
      tracer_seconds += seconds_of([&] { tracers.step(step); });
      ++summary.steps;
      summary.interrupted_at = step.t1();
      progress.show(step.t1(), k, fmt::format("{} steps a frame", steps));
      return !guard.interrupted();
    });
    if (!arrived) break;
    surfaces.settle();
    write_frame(writer, folder, k, next, surfaces, tracer_seconds, summary);
  }
  summary.interrupted_by = guard.signal();
  return summary;
}

}  // namespace

int track(const TrackOptions& options) {
  const InterruptGuard guard;
  const Stopwatch watch;
  ParticleSequence sequence(file_series(options.inputs), options.frames_per_second);
  const TrackSetup setup = make_setup(options, sequence, sequence.frame(0).particles);
  if (sequence.velocity() == ParticleSequence::Velocity::unknown) check_cloud_motion(sequence, setup.field);
  const double setup_seconds = watch.seconds();
  RunSummary summary = track_sequence(options, sequence, setup, guard);
  summary.setup_seconds = setup_seconds;
  summary.wall_seconds = watch.seconds();
  if (!options.quiet)
    fmt::print("{}", summary_text(summary, sequence.name(), setup.field, folder_for(options, sequence)));
  if (summary.interrupted_by == 0) return 0;
  fmt::print(stderr, "kappaflow: interrupted at t = {:.6g} s; {} frames are complete\n",
             summary.interrupted_at, summary.frames.size());
  return exit_code_after(summary.interrupted_by);
}

}  // namespace kappaflow
