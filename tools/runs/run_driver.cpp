#include "tools/runs/run_driver.h"

#include <fmt/format.h>

#include <utility>

#include "core/errors.h"
#include "core/state_bytes.h"
#include "tools/runs/progress.h"

namespace kappaflow {
namespace {

/// What the surfaces are of, for the summary.
std::string field_text(const FrameSource& source) {
  if (const ParticleFieldOptions* field = source.particle_field())
    return fmt::format("threshold {:.6g}, sigma {:.4g} m", field->threshold, field->sigma);
  return fmt::format("length scale {:.4g} m", source.surfaces().length_scale());
}

}  // namespace

RunDriver::RunDriver(FrameSource& source, RunFolder& folder, RunSettings settings, const Stopwatch& watch)
    : source_(source),
      folder_(folder),
      settings_(std::move(settings)),
      watch_(watch),
      writer_(source, settings_.output, settings_.methods, settings_.formats, folder) {
  summary_.density_tolerance = settings_.density_tolerance;
}

void RunDriver::start() {
  summary_.setup_seconds = watch_.seconds() - source_.surfaces().first_mesh_seconds();
  write_frame(0);
  write_checkpoint();
  folder_.take_place();
}

// What follows from the source or stands in the tables is not in the checkpoint: it would grow with each
// frame.
void RunDriver::restore(int frame, SavedRun& saved) {
  saved.read(*this);
  saved.require_end();
  frame_ = frame;
  std::vector<double> times;
  for (int k = 0; k <= frame_; ++k) times.push_back(source_.time_of(k));
  folder_.set_times(std::move(times));
  summary_.add_frames_before(folder_.metrics());
  summary_.setup_seconds = watch_.seconds();
}

RunSummary RunDriver::advance(const InterruptGuard& guard) {
  try {
    advance_frames(guard);
    folder_.wait();
  } catch (const IoError& error) {
    throw Error(fmt::format("{}; once that is repaired, kappaflow {} --resume {} goes on", error.what(),
                            settings_.command, folder_.path().string()),
                error.exit_code());
  }
  summary_.steps = source_.steps();
  summary_.wall_seconds = watch_.seconds();
  summary_.interrupted_by = guard.signal();
  summary_.interrupted_at = source_.time();
  summary_.text = summary_text(summary_, settings_.title, field_text(source_), folder_.path());
  return std::move(summary_);
}

void RunDriver::advance_frames(const InterruptGuard& guard) {
  const int last = source_.last_frame();
  Progress progress(source_.time(), source_.time_of(last), last, !settings_.quiet);
  bool stops = guard.interrupted() && source_.can_be_saved();
  while (frame_ < last && !stops) {
    const int next = frame_ + 1;
    source_.prepare(next);
    const bool arrived = go_to(next, [&](const std::string& detail) {
      progress.show(source_.time(), next, detail);
      return !guard.interrupted();
    });
    if (!arrived && !source_.saves_between_frames()) return;
    stops = guard.interrupted() && source_.can_be_saved();
    if (stops || frame_ == last || frame_ % settings_.output.checkpoint_interval == 0) write_checkpoint();
  }
}

/// Advances the source and writes the frame, unless `watch` stops it on the way. Errors of surfaces, which
/// know no time, are given one.
bool RunDriver::go_to(int frame, const FrameSource::Watch& watch) try {
  const bool arrived = source_.advance(frame, watch);
  if (arrived) write_frame(frame);
  return arrived;
} catch (const SolverFailure& failure) {
  throw Error(fmt::format("{}; {}", failure.what(), kept_particles()), failure.exit_code());
} catch (const IoError&) {
  throw;
} catch (const Error& error) {
  throw Error(fmt::format("the surfaces failed at t = {:.6g} s, step {}: {}; {}", source_.time(),
                          source_.steps(), error.what(), kept_particles()),
              error.exit_code());
}

std::string RunDriver::kept_particles() const {
  return source_.kept_particles(folder_.path() / kFailureFile);
}

void RunDriver::write_frame(int frame) {
  writer_.write(frame, source_, summary_);
  frame_ = frame;
}

void RunDriver::write_checkpoint() {
  folder_.write_checkpoint(bytes_written([this](StateWriter& archive) {
    archive(settings_.command);
    settings_.save_beginning(archive);
    archive(frame_, *this);
  }));
}

int run_outcome(const RunSummary& summary, const std::string& command, const std::filesystem::path& folder,
                bool quiet) {
  if (!quiet) fmt::print("{}", summary.text);
  if (summary.interrupted_by == 0) return 0;
  fmt::print(stderr,
             "kappaflow: interrupted at t = {:.6g} s; {} frames are complete; kappaflow {} --resume {} goes "
             "on\n",
             summary.interrupted_at, summary.frames.size(), command, folder.string());
  return exit_code_after(summary.interrupted_by);
}

RunSummary complete_run(const std::filesystem::path& folder, int frame) {
  RunSummary summary;
  summary.text = fmt::format("{}: the run is complete, {} frames\n", folder.string(), frame + 1);
  return summary;
}

}  // namespace kappaflow
