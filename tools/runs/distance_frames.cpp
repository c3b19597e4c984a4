#include "tools/runs/distance_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/stopwatch.h"
#include "core/whole_within.h"

namespace kappaflow {

DistanceFrames::DistanceFrames(DistanceSequence& sequence, const SurfaceOptions& options, bool with_tracers)
    : sequence_(sequence),
      motion_per_step_(options.motion_per_step),
      motion_(sequence.motion_from(0)),
      surfaces_(motion_->at(sequence.time(0)), options),
      tracers_(with_tracers && sequence.has_velocity() ? std::span<const Vec3>(surfaces_.mesh().position)
                                                       : std::span<const Vec3>()),
      time_(sequence.time(0)) {}

void DistanceFrames::prepare(int frame) {
  if (!motion_ || prepared_for_ != frame)
    motion_.emplace(sequence_.motion_from(static_cast<std::size_t>(frame) - 1));
  prepared_for_ = frame;
}

bool DistanceFrames::advance(int /*frame*/, const Watch& watch) {
  constexpr int kMostSteps = 1000;
  const double way = std::max(motion_->displacement(), motion_->material_displacement());
  const double steps = way / (motion_per_step_ * surfaces_.length_scale());
  const int count = whole_within(std::ceil(steps), 1, kMostSteps);
  const std::string detail = fmt::format("{} steps a frame", count);
  const bool arrived = surfaces_.step(*motion_, count, [&](FieldMotion& step) {
    tracer_seconds_ += seconds_of([&] { tracers_.step(step); });
    time_ = step.t1();
    ++steps_;
    return watch(detail);
  });
  motion_.reset();
  if (arrived) surfaces_.settle();
  return arrived;
}

FrameReport DistanceFrames::take_report(int frame) {
  FrameReport report;
  report.metrics.frame = frame;
  report.metrics.time = time_of(frame);
  report.steps = surfaces_.take_report();
  report.tracer_seconds = std::exchange(tracer_seconds_, 0);
  return report;
}

std::string DistanceFrames::kept_particles(const std::filesystem::path& /*file*/) const {
  return fmt::format("the surface is in {}",
                     sequence_.series().files[static_cast<std::size_t>(prepared_for_)].string());
}

}  // namespace kappaflow
