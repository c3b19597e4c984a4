#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/errors.h"
#include "tools/runs/distance_frames.h"
#include "tools/runs/track_input.h"

namespace kappaflow {
namespace {

/// Throws InvalidInput for options that say how particles become a field.
void refuse_particle_options(const TrackOptions& options, const std::string& name, InputKind kind) {
  const auto refuse = [&](const char* option) {
    throw InvalidInput(
        fmt::format("{}: {} is for particles; these are {}", name, option, name_of(kInputKinds, kind)));
  };
  if (options.sigma) refuse("--sigma");
  if (options.threshold) refuse("--threshold");
  if (options.weights != WeightRule::uniform) refuse("--weights");
  if (options.kernels != Kernels::round) refuse("--kernels");
  if (options.anchor != Anchor::none) refuse("--anchor");
  if (std::ranges::count(options.methods, "fresh-particles") > 0) refuse("the method \"fresh-particles\"");
}

class DistanceInput final : public TrackInput {
 public:
  DistanceInput(const FileSeries& series, InputKind kind, const TrackOptions& options, const FileWatch& watch)
      : sequence_(series, kind, options.frames_per_second, watch) {
    surface_.methods = options.methods;
    surface_.is_cloud = !sequence_.has_velocity();
    if (surface_.methods.empty()) surface_.methods = {surface_.is_cloud ? "regional" : "material"};
    for (const char* method : {"material", "fresh-grid"})
      if (surface_.is_cloud && std::ranges::count(surface_.methods, method) > 0)
        throw InvalidInput(fmt::format(
            "{}: the velocity \"{}\" takes images with velocities; these have none", series.name, method));
    surface_.velocities = surface_methods_named(surface_.methods);
    surface_.name = series.name;
    surface_.edge_length = edge_length_in(length_scale(), options);
  }

  const FileSeries& series() const override { return sequence_.series(); }
  const std::string& hash() const override { return sequence_.hash(); }
  const std::vector<std::string>& notes() const override { return sequence_.notes(); }
  double time(std::size_t frame) const override { return sequence_.time(frame); }
  const SurfaceDescription& surface() const override { return surface_; }
  double length_scale() const override { return DistanceField::kLengthScale * sequence_.spacing(); }
  std::optional<double> threshold() const override { return std::nullopt; }
  void check_motion() override {
    for (std::size_t k = 0; k + 1 < size(); ++k) sequence_.motion_from(k);
  }
  std::unique_ptr<FrameSource> frames(bool with_tracers) override {
    return std::make_unique<DistanceFrames>(sequence_, surface_, with_tracers);
  }
  std::string setup_text() const override {
    return fmt::format("  spacing {:.6g} m, sigma {:.6g} m ({} spacings)\n", sequence_.spacing(),
                       length_scale(), DistanceField::kLengthScale);
  }

 private:
  DistanceSequence sequence_;
  SurfaceDescription surface_;
};

}  // namespace

std::unique_ptr<TrackInput> distance_input(const FileSeries& series, InputKind kind,
                                           const TrackOptions& options, const FileWatch& watch) {
  refuse_particle_options(options, series.name, kind);
  return std::make_unique<DistanceInput>(series, kind, options, watch);
}

}  // namespace kappaflow
