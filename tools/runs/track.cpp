#include "tools/runs/track.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>

#include "core/errors.h"
#include "core/parallel.h"
#include "core/quantile.h"
#include "core/solid_distance.h"
#include "core/whole_within.h"
#include "surface/mesh/isosurface.h"
#include "tools/runs/frame_writer.h"
#include "tools/runs/interrupt.h"
#include "tools/runs/progress.h"
#include "tools/runs/run_record.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr double kMotionPerStep = 0.2;    // of the fast particles, in sigma
constexpr double kShareOfFast = 0.999;    // a few that fly off do not set the number of steps
constexpr double kCheckerSize = 2;        // in sigma
constexpr double kMeasuredShare = 0.95;   // of the vertices, see surface_motion()
constexpr double kMeasuredSpacing = 0.5;  // of the surfaces there, in sigma

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
  setup.field = field_options(surface, options.sigma ? 1 : setup.spacing, first.position);
  return setup;
}

fs::path folder_for(const TrackOptions& options, const ParticleSequence& sequence) {
  return options.folder.empty() ? fs::path("out") / sequence.name() : options.folder;
}

/// The field's options between a frame and the next.
ParticleFieldOptions options_between(const ParticleSequence& sequence, std::size_t frame,
                                     const ParticleFieldOptions& field) {
  ParticleFieldOptions options = field;
  if (sequence.velocity() == ParticleSequence::Velocity::unknown)
    options.cloud_speed =
        kLargestCloudMotion * field.sigma / (sequence.time(frame + 1) - sequence.time(frame));
  return options;
}

/// The speed [m/s] that all but a few particles stay below.
double fast_speed(const Particles& particles) {
  std::vector<double> speed;
  for (const Vec3& v : particles.velocity) speed.push_back(v.norm());
  return quantile(speed, kShareOfFast);
}

/// name: of the sequence. Throws InvalidInput where the steps would never end.
int steps_between(const Particles& before, const Particles& after, const ParticleFieldOptions& field,
                  const std::string& name) {
  constexpr int kMost = 1000000;
  const double speed = std::max({fast_speed(before), fast_speed(after), field.cloud_speed});
  const double motion = speed * (after.time - before.time) / (kMotionPerStep * field.sigma);
  if (!(motion <= kMost))
    throw InvalidInput(
        fmt::format("{}: particles at {:.3g} m/s move {:.3g} sigma from the frame at {:.6g} s to "
                    "the next; at most {:.3g} are allowed",
                    name, speed, motion * kMotionPerStep, before.time, kMost * kMotionPerStep));
  return whole_within(std::ceil(motion), 1, kMost);
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

/// Moves the surfaces to the motion's end. Returns false when `watch(time)` stopped it on the way.
template <class Watch>
bool advance(TrackedSurfaces& surfaces, ParticleMotion& motion, int steps, const Watch& watch) {
  const double t0 = motion.t0(), dt = (motion.t1() - t0) / steps;
  double time = t0;
  for (int s = 1; s <= steps; ++s) {
    const double end = s == steps ? motion.t1() : t0 + s * dt;
    MotionPart part(motion, time, end);
    surfaces.step(part);
    motion.forget_before(end);
    time = end;
    if (!watch(time) && s < steps) return false;
  }
  surfaces.settle();
  return true;
}

void write_frame(FrameWriter& writer, RunFolder& folder, int number, const SequenceFrame& frame,
                 TrackedSurfaces& surfaces, RunSummary& summary) {
  const Stopwatch watch;
  surfaces.find_sources(frame.particles.position, frame.source);
  const ParticleFieldOptions& field = surfaces.field_options();
  const std::vector<double> weight = field_weights(frame.particles.position, field.sigma, field.weights);
  FrameMetrics metrics;
  metrics.frame = number;
  metrics.time = frame.particles.time;
  writer.write(metrics, {frame.particles, frame.density, frame.pressure, frame.source, weight, field.sigma},
               surfaces.take_since_frame(), watch, summary);
  folder.flush();
}

RunSummary track_sequence(const TrackOptions& options, ParticleSequence& sequence, const TrackSetup& setup,
                          const InterruptGuard& guard) {
  const auto motion_from = [&](const SequenceFrame& before, const SequenceFrame& after, std::size_t frame) {
    return std::make_unique<ParticleMotion>(before.particles, after.particles,
                                            options_between(sequence, frame, setup.field));
  };
  SequenceFrame now = sequence.frame(0), next = sequence.frame(1);
  auto motion = motion_from(now, next, 0);
  TrackedSurfaces surfaces(motion->at(motion->t0()), setup.field, setup.surface, sequence.file(0).string());

  RunFolder folder(folder_for(options, sequence), setup.surface.methods, options.force);
  folder.write_record(track_record(options, sequence, setup.surface, setup.field));
  if (!options.quiet) fmt::print("{}", setup_text(sequence, setup, options));
  std::fflush(stdout);
  OutputDescription output;
  output.checker_size = kCheckerSize;
  FrameWriter writer(output, surfaces, options.formats, folder);
  RunSummary summary;
  write_frame(writer, folder, 0, now, surfaces, summary);
  folder.take_place();
  const int last = static_cast<int>(sequence.size()) - 1;
  Progress progress(sequence.time(0), sequence.time(last), last, !options.quiet);
  for (int k = 1; k <= last && !guard.interrupted(); ++k) {
    if (k > 1) {
      next = sequence.frame(k);
      motion = motion_from(now, next, k - 1);
    }
    const int steps = steps_between(now.particles, next.particles,
                                    options_between(sequence, k - 1, setup.field), sequence.name());
    const bool arrived = advance(surfaces, *motion, steps, [&](double time) {
      ++summary.steps;
      summary.interrupted_at = time;
      progress.show(time, k, fmt::format("{} steps a frame", steps));
      return !guard.interrupted();
    });
    now = std::move(next);
    if (arrived) write_frame(writer, folder, k, now, surfaces, summary);
  }
  summary.interrupted_by = guard.signal();
  return summary;
}

}  // namespace

double surface_motion(const Field& before, const Field& after, double sigma) {
  const TriangleMesh from = extract_isosurface(before, kMeasuredSpacing * sigma),
                     to = extract_isosurface(after, kMeasuredSpacing * sigma);
  if (from.triangles.empty() || to.triangles.empty()) return 0;
  const SolidDistance surface(TriangleSurface{from.position, from.triangles});
  std::vector<double> distance(to.vertex_count());
  parallel_for(distance.size(),
               [&](std::size_t v) { distance[v] = std::abs(surface.nearest(to.position[v]).distance); });
  return quantile(distance, kMeasuredShare) / sigma;
}

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
