#include "tools/runs/track.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "core/errors.h"
#include "surface/measure/surface_metrics.h"
#include "surface/measure/surface_motion.h"
#include "tools/io/particle_sequence.h"
#include "tools/runs/progress.h"
#include "tools/runs/run_driver.h"
#include "tools/runs/run_record.h"
#include "tools/runs/sequence_frames.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTrackCommand = "track";
constexpr double kEdgeLength = 0.25;  // of sigma: half a particle spacing

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
    return particle_spacing(first.position, first.scale);
  } catch (const InvalidInput&) {
    const Coincidence found = coincident_particles(first.position);
    throw InvalidInput(
        file,
        fmt::format("{} of {} particles are where others are, e.g. {} and {}, and have no spacing; keep one "
                    "in a place, or {}",
                    found.count, first.size(), first.id[found.first], first.id[found.second], kAdvice));
  }
}

/// Throws InvalidInput where a surface follows velocities that nobody knows.
void require_velocities(const SurfaceDescription& surface, const ParticleSequence& sequence) {
  for (const char* method : {"material", "fresh-grid"})
    if (std::ranges::count(surface.methods, method) > 0)
      throw InvalidInput(
          fmt::format("{}: the velocity \"{}\" takes particles with velocities or ids; these have neither",
                      sequence.name(), method));
}

/// Throws InvalidInput where textures are to come from particles that cannot be told apart.
void require_ids(const SurfaceDescription& surface, const ParticleSequence& sequence) {
  const bool is_anchored = surface.anchor == Anchor::particles;
  if (sequence.matched() || (!is_anchored && std::ranges::count(surface.methods, "fresh-particles") == 0))
    return;
  throw InvalidInput(fmt::format("{}: {} takes particles with ids that say which is which", sequence.name(),
                                 is_anchored ? "--anchor particles" : "the method \"fresh-particles\""));
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
  if (is_cloud) require_velocities(surface, sequence);
  surface.anchor = options.anchor;
  require_ids(surface, sequence);
  surface.spacing = options.sigma ? 1 : setup.spacing;
  surface.is_cloud = is_cloud;
  surface.velocities = surface_methods_named(surface.methods);
  surface.name = sequence.name();
  setup.field = field_options(surface, first.position, first.scale);
  surface.edge_length = options.edge_length ? *options.edge_length / setup.field.sigma : kEdgeLength;
  if (surface.edge_length < kFinestEdge || surface.edge_length > kCoarsestEdge)
    throw InvalidInput(fmt::format(
        "--edge: found {:.4g} m; expected {:.4g} to {:.4g} m, which is {} to {} sigma", *options.edge_length,
        kFinestEdge * setup.field.sigma, kCoarsestEdge * setup.field.sigma, kFinestEdge, kCoarsestEdge));
  return setup;
}

fs::path folder_for(const TrackOptions& options, const ParticleSequence& sequence) {
  return options.folder.empty() ? fs::path("out") / sequence.name() : options.folder;
}

/// Throws InvalidInput where a point cloud's surface moves too far between two frames.
void check_motion_of_frames(ParticleSequence& sequence, const ParticleFieldOptions& field) {
  auto before = particle_field(sequence.frame(0).particles, field);
  for (std::size_t k = 1; k < sequence.size(); ++k) {
    auto after = particle_field(sequence.frame(k).particles, field);
    check_cloud_motion(sequence.file(k).string(), *before, *after, field.sigma);
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

/// A line where many particles have no surface: in a spray, or where a body is coarser than the others.
std::string outside_text(const TrackedSurfaces& surfaces) {
  constexpr double kWorthSaying = 0.01;
  const std::vector<Vec3>& position = surfaces.particles().position;
  const double share =
      static_cast<double>(points_outside(surfaces.field(), position)) / static_cast<double>(position.size());
  if (share < kWorthSaying) return {};
  return fmt::format(
      "  {:.0f} % of the particles are outside the surface in the first frame: too far from others for this "
      "sigma. Spray is; for a coarser body give the particles a radius, or a larger --sigma; --weights "
      "normalised keeps them all\n",
      100 * share);
}

/// The files where anybody finds them, as a checkpoint has them.
FileSeries absolute(FileSeries series) {
  for (fs::path& file : series.files) file = fs::absolute(file);
  return series;
}

RunSettings settings_for(const TrackOptions& options, const ParticleSequence& sequence,
                         const TrackSetup& setup) {
  OutputDescription output;
  if (options.checker_edge) output.checker_size = *options.checker_edge / setup.field.sigma;
  output.texture = options.texture;
  output.metrics_interval = options.metrics_interval;
  output.rest_interval = options.rest_interval;
  return {.command = kTrackCommand,
          .title = sequence.name(),
          .output = output,
          .methods = setup.surface.methods,
          .formats = options.formats,
          .quiet = options.quiet,
          .save_beginning = [options, series = absolute(sequence.series()), hash = sequence.hash()](
                                StateWriter& archive) { archive(options, series, hash); }};
}

/// Reads and checks all files, and says so from the first second on.
ParticleSequence read_sequence(const FileSeries& series, const TrackOptions& options) {
  WorkProgress progress("checking file", static_cast<int>(series.files.size()), !options.quiet);
  return {series, options.frames_per_second,
          [&](std::size_t file) { progress.show(static_cast<int>(file)); }};
}

SequenceFrames first_frame(ParticleSequence& sequence, const SurfaceOptions& surface,
                           const TrackOptions& options) {
  StatusLine status(!options.quiet);
  status.show("making the first mesh");
  return {sequence, surface, options.metrics_interval > 0};
}

// Until there is something to save a signal ends the program at once.
RunSummary begin(const TrackOptions& options, ParticleSequence& sequence, const Stopwatch& watch) {
  const TrackSetup setup = make_setup(options, sequence, sequence.frame(0).particles);
  if (setup.surface.is_cloud) check_motion_of_frames(sequence, setup.field);
  SequenceFrames frames = first_frame(sequence, setup.surface, options);
  const InterruptGuard guard;
  RunFolder folder(folder_for(options, sequence), setup.surface.methods, options.force);
  folder.write_record(track_record(options, sequence, setup.surface, setup.field));
  if (!options.quiet)
    fmt::print("{}{}", setup_text(sequence, setup, options), outside_text(frames.surfaces()));
  std::fflush(stdout);
  RunDriver driver(frames, folder, settings_for(options, sequence, setup), watch);
  driver.start();
  return driver.advance(guard);
}

RunSummary resume(const TrackOptions& options) {
  const InterruptGuard guard;
  const Stopwatch watch;
  RunFolder folder(options.resume);
  SavedRun saved(folder.path(), kTrackCommand);
  TrackOptions begun;
  FileSeries series;
  std::string hash;
  int frame = 0;
  saved.read(begun, series, hash, frame);
  begun.quiet = options.quiet;
  if (frame + 1 == std::ssize(series.files)) return complete_run(folder.path(), frame);

  if (!options.inputs.empty()) series = file_series(options.inputs, begun.range);
  ParticleSequence sequence = read_sequence(series, begun);
  if (sequence.hash() != hash)
    throw InvalidInput(fmt::format("{}: the particles are not those that the run in {} began with",
                                   sequence.name(), folder.path().string()));
  const TrackSetup setup = make_setup(begun, sequence, sequence.frame(0).particles);
  SequenceFrames frames = first_frame(sequence, setup.surface, begun);
  RunDriver driver(frames, folder, settings_for(begun, sequence, setup), watch);
  driver.restore(frame, saved);
  folder.write_record(resumed_record(folder.path(), options.command, options.threads, frames.time()));
  return driver.advance(guard);
}

}  // namespace

int track(const TrackOptions& options) {
  if (!options.resume.empty())
    return run_outcome(resume(options), kTrackCommand, options.resume, options.quiet);
  const Stopwatch watch;
  ParticleSequence sequence = read_sequence(file_series(options.inputs, options.range), options);
  return run_outcome(begin(options, sequence, watch), kTrackCommand, folder_for(options, sequence),
                     options.quiet);
}

}  // namespace kappaflow
