#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/errors.h"
#include "surface/measure/surface_metrics.h"
#include "surface/measure/surface_motion.h"
#include "tools/io/particle_sequence.h"
#include "tools/io/particle_survey.h"
#include "tools/runs/sequence_frames.h"
#include "tools/runs/track_input.h"

namespace kappaflow {
namespace {

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

/// Textures that come from the particles ask where each was first, and anisotropic kernels look far.
ParticleChoice choice_for(const TrackOptions& options) {
  return {.all = options.kernels != Kernels::round || options.anchor == Anchor::particles ||
                 std::ranges::count(options.methods, "fresh-particles") > 0,
          .many = options.many_particles,
          .sigma = options.sigma};
}

class ParticleInput final : public TrackInput {
 public:
  ParticleInput(const FileSeries& series, const TrackOptions& options, const FileWatch& watch)
      : sequence_(series, options.frames_per_second, watch, choice_for(options)) {
    const Particles first = sequence_.frame(0).particles;
    set_surface(options, first);
    if (!sequence_.keeps_all() && !options.threshold) surface_.threshold = threshold_inside();
    field_ = field_options(surface_, first.position, first.scale);
    surface_.edge_length = edge_length_in(field_.sigma, options);
  }

  const FileSeries& series() const override { return sequence_.series(); }
  const std::string& hash() const override { return sequence_.hash(); }
  const std::vector<std::string>& notes() const override { return sequence_.notes(); }
  double time(std::size_t frame) const override { return sequence_.time(frame); }
  const SurfaceDescription& surface() const override { return surface_; }
  double length_scale() const override { return field_.sigma; }
  std::optional<double> threshold() const override { return field_.threshold; }
  void check_motion() override;
  std::unique_ptr<FrameSource> frames(bool with_tracers) override {
    return std::make_unique<SequenceFrames>(sequence_, surface_, with_tracers);
  }
  std::string setup_text() const override;
  std::string warning(const FrameSource& frames) const override;

 private:
  void set_surface(const TrackOptions& options, const Particles& first);
  double spacing_inside();
  double threshold_inside();

  ParticleSequence sequence_;
  SurfaceDescription surface_;
  ParticleFieldOptions field_;
  bool threshold_given_ = false;
  double spacing_ = 0;  // measured [m]; 0 where sigma is given
};

void ParticleInput::set_surface(const TrackOptions& options, const Particles& first) {
  surface_.sigma = options.sigma.value_or(usual_sigma(options.kernels));
  if (!options.sigma)
    spacing_ = sequence_.keeps_all() ? measured_spacing(sequence_, first) : spacing_inside();
  surface_.threshold = options.threshold;
  threshold_given_ = options.threshold.has_value();
  surface_.weights = options.weights;
  surface_.kernels = options.kernels;
  const bool is_cloud = sequence_.velocity() == ParticleSequence::Velocity::unknown;
  surface_.methods = options.methods;
  if (surface_.methods.empty()) surface_.methods = {is_cloud ? "regional" : "material"};
  if (is_cloud) require_velocities(surface_, sequence_);
  surface_.anchor = options.anchor;
  require_ids(surface_, sequence_);
  surface_.spacing = options.sigma ? 1 : spacing_;
  surface_.is_cloud = is_cloud;
  surface_.velocities = surface_methods_named(surface_.methods);
  surface_.name = sequence_.name();
}

/// Where particles of the depth are left out those count that are a little way in.
double ParticleInput::spacing_inside() {
  const auto [position, counted] = sequence_.inside();
  return particle_spacing(position, {}, counted);
}

double ParticleInput::threshold_inside() {
  const auto [position, counted] = sequence_.inside();
  const double sigma = surface_.sigma * *surface_.spacing;
  return half_median_threshold(position, field_weights(position, sigma, surface_.weights), sigma, {},
                               counted);
}

/// A point cloud's surface must not move too far between two frames.
void ParticleInput::check_motion() {
  if (!surface_.is_cloud) return;
  ParticleFieldOptions round = field_;  // which lie where others do, but for the waves
  round.kernels = Kernels::round;
  auto before = particle_field(sequence_.frame(0).particles, round);
  for (std::size_t k = 1; k < sequence_.size(); ++k) {
    auto after = particle_field(sequence_.frame(k).particles, round);
    check_cloud_motion(sequence_.file(k).string(), *before, *after, field_.sigma);
    before = std::move(after);
  }
}

std::string ParticleInput::setup_text() const {
  const std::string sigma = spacing_ > 0
                                ? fmt::format("spacing {:.6g} m (measured), sigma {:.6g} m ({} spacings)",
                                              spacing_, field_.sigma, surface_.sigma)
                                : fmt::format("sigma {:.6g} m (given)", field_.sigma);
  return fmt::format("  {}, threshold {:.6g} ({})\n", sigma, field_.threshold,
                     threshold_given_ ? "given" : "half the field's median at the particles");
}

/// A line where many particles have no surface: in a spray, or where a body is coarser than the others.
std::string ParticleInput::warning(const FrameSource& frames) const {
  constexpr double kWorthSaying = 0.01;
  const std::vector<Vec3>& position =
      static_cast<const SequenceFrames&>(frames).surfaces().particles().position;
  const double share = static_cast<double>(points_outside(frames.surfaces().field(), position)) /
                       static_cast<double>(sequence_.particles_in(0));
  if (share < kWorthSaying) return {};
  return fmt::format(
      "  {:.0f} % of the particles are outside the surface in the first frame: too far from others for this "
      "sigma. Spray is; for a coarser body give the particles a radius, or a larger --sigma; --kernels "
      "anisotropic keeps sheets and threads, --weights normalised keeps them all\n",
      100 * share);
}

}  // namespace

std::unique_ptr<TrackInput> particle_input(const FileSeries& series, const TrackOptions& options,
                                           const FileWatch& watch) {
  return std::make_unique<ParticleInput>(series, options, watch);
}

}  // namespace kappaflow
