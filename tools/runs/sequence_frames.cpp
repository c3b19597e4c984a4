#include "tools/runs/sequence_frames.h"

#include <fmt/format.h>

#include <utility>

#include "core/stopwatch.h"
#include "tools/runs/surface_temperature.h"

namespace kappaflow {
namespace {

/// The particles of a frame that those of the frame before it go on to.
Particles arrival(ParticleSequence& sequence, std::size_t frame, const Particles& before) {
  return sequence.keeps_all() ? sequence.frame(frame).particles : sequence.arrival(frame, before.id);
}

}  // namespace

SequenceFrames::SequenceFrames(ParticleSequence& sequence, const SurfaceOptions& options, bool with_tracers)
    : sequence_(sequence),
      now_(sequence.frame(0)),
      surfaces_(now_.particles, arrival(sequence, 1, now_.particles), options),
      tracers_(with_tracers ? std::span<const Vec3>(surfaces_.mesh().position) : std::span<const Vec3>()),
      time_(sequence.time(0)),
      has_temperatures_(!now_.temperature.empty()) {
  surfaces_.find_sources(now_.source);
  if (has_temperatures_) add_temperatures(surfaces_);
}

void SequenceFrames::prepare(int frame) {
  const auto k = static_cast<std::size_t>(frame);
  prepared_for_ = k;
  now_ = {};  // has been reported, and what is asked of it is in the surfaces
  next_ = arrival(sequence_, k, surfaces_.particles());
  speed_to_next_ = sequence_.keeps_all() ? 0 : sequence_.fast_speed_to(k);
  steps_to_next_ = surfaces_.steps_to(next_, speed_to_next_);
}

bool SequenceFrames::advance(int /*frame*/, const Watch& watch) {
  const std::string detail = fmt::format("{} steps a frame", steps_to_next_);
  const bool arrived = surfaces_.step(
      std::move(next_),
      [&](FieldMotion& step) {
        tracer_seconds_ += seconds_of([&] { tracers_.step(step); });
        time_ = step.t1();
        ++steps_;
        return watch(detail);
      },
      speed_to_next_);
  if (!arrived) return false;
  now_ = sequence_.frame(prepared_for_);
  if (!sequence_.keeps_all()) surfaces_.go_on_with(now_.particles);
  surfaces_.settle(now_.source);
  return true;
}

FrameReport SequenceFrames::take_report(int frame) {
  FrameReport report;
  report.metrics.frame = frame;
  report.metrics.time = time_of(frame);
  report.metrics.particles = sequence_.particles_in(static_cast<std::size_t>(frame));
  report.particles = now_;
  if (const auto range = temperature_range(now_.temperature); has_temperatures_ && range)
    set_temperatures(now_, *range, surfaces_, report.metrics);
  report.steps = surfaces_.take_report();
  report.tracer_seconds = std::exchange(tracer_seconds_, 0);
  return report;
}

std::string SequenceFrames::kept_particles(const std::filesystem::path& /*file*/) const {
  return fmt::format("its particles are in {}", sequence_.file(prepared_for_).string());
}

}  // namespace kappaflow
