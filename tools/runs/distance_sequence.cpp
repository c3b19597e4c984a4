#include "tools/runs/distance_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/solid_distance.h"
#include "surface/mesh/mesh_distances.h"

namespace kappaflow {
namespace {

constexpr std::size_t kImagesKept = 4;  // of a motion: two, and those around them

// A mesh's distances reach as many spacings of the grid from it, and so many times as far as it moves from a
// frame to the next: where it is two frames later they still have to say how far away it was.
constexpr double kReach = 5, kReachOfMotion = 2.5;

/// A surface may move by this share of the way that its distances reach: beyond it they are cut off.
constexpr double kLargestMotion = 0.5;

/// The mean length of the triangles' edges.
double mean_edge(const TriangleSurface& surface) {
  double sum = 0;
  for (const Triangle& t : surface.triangles)
    for (int c = 0; c < 3; ++c) sum += (surface.vertices[t[c]] - surface.vertices[t[(c + 1) % 3]]).norm();
  return sum / (3 * static_cast<double>(surface.triangles.size()));
}

/// Whether all values at the border are negative and some others are not: then positive is inside.
bool is_positive_inside(const ImageFrame& image) {
  bool any_positive = false;
  for (int k = 0, p = 0; k < image.dims[2]; ++k)
    for (int j = 0; j < image.dims[1]; ++j)
      for (int i = 0; i < image.dims[0]; ++i, ++p) {
        const bool at_border = i == 0 || j == 0 || k == 0 || i == image.dims[0] - 1 ||
                               j == image.dims[1] - 1 || k == image.dims[2] - 1;
        if (image.value[p] >= 0 && at_border) return false;
        any_positive = any_positive || image.value[p] > 0;
      }
  return any_positive;
}

}  // namespace

DistanceSequence::DistanceSequence(const FileSeries& series, InputKind kind,
                                   std::optional<double> frames_per_second,
                                   const std::function<void(std::size_t file)>& watch)
    : frames_(kind == InputKind::images ? decltype(frames_)(ImageSequence(series, frames_per_second, watch))
                                        : decltype(frames_)(MeshSequence(series, frames_per_second, watch))) {
  notes_ = std::visit([](const auto& frames) { return frames.notes(); }, frames_);
  if (const auto* images = std::get_if<ImageSequence>(&frames_)) {
    const ImageFrame first = images->frame(0);
    origin_ = first.origin;
    spacing_ = first.spacing.maxCoeff();
    has_velocity_ = !first.velocity.empty();
    positive_inside_ = is_positive_inside(first);
    if (positive_inside_) notes_.emplace_back("negative all around: positive is taken for inside");
  } else {
    spacing_ = mean_edge(std::get<MeshSequence>(frames_).frame(0).surface);
  }
  motion_.resize(this->size());
}

const FileSeries& DistanceSequence::series() const {
  return std::visit([](const auto& frames) -> const FileSeries& { return frames.series(); }, frames_);
}

const std::string& DistanceSequence::hash() const {
  return std::visit([](const auto& frames) -> const std::string& { return frames.hash(); }, frames_);
}

double DistanceSequence::time(std::size_t frame) const {
  return std::visit([frame](const auto& frames) { return frames.time(frame); }, frames_);
}

DistanceMotion DistanceSequence::motion_from(std::size_t frame) {
  const Image before = frame > 0 ? image(frame - 1) : nullptr, from = image(frame), to = image(frame + 1),
              after = frame + 2 < size() ? image(frame + 2) : nullptr;
  DistanceMotion motion(from, to, before, after);
  const double reach = std::min(from->reach(), to->reach());
  if (motion.displacement() > kLargestMotion * reach)
    throw InvalidInput(
        {series().files[frame + 1].string()},
        fmt::format("the surface moves by {:.3g} m since the frame before, and its distances reach {:.3g} m; "
                    "at most {} of that is allowed: more frames, or distances that reach further",
                    motion.displacement(), reach, kLargestMotion));
  return motion;
}

DistanceMotion::Image DistanceSequence::image(std::size_t frame) {
  const auto found = std::ranges::find(images_, frame, &std::pair<std::size_t, Image>::first);
  if (found != images_.end()) return found->second;
  const auto* images = std::get_if<ImageSequence>(&frames_);
  try {
    images_.emplace_back(frame, images != nullptr ? make_image(images->frame(frame), time(frame))
                                                  : make_image(std::get<MeshSequence>(frames_), frame));
  } catch (const InvalidInput& error) {
    throw InvalidInput({series().files[frame].string()}, error.what());
  }
  if (images_.size() > kImagesKept) images_.pop_front();
  return images_.back().second;
}

DistanceMotion::Image DistanceSequence::make_image(const ImageFrame& frame, double time) const {
  SignedDistances distances{.grid = {.origin = origin_, .spacing = frame.spacing, .dims = frame.dims},
                            .value = frame.value,
                            .velocity = frame.velocity};
  for (int a = 0; a < 3; ++a)
    distances.grid.first[a] =
        static_cast<int>(std::lround((frame.origin[a] - origin_[a]) / frame.spacing[a]));
  if (positive_inside_)
    for (float& value : distances.value) value = -value;
  return std::make_shared<DistanceImage>(distances, time);
}

DistanceMotion::Image DistanceSequence::make_image(const MeshSequence& meshes, std::size_t frame) {
  double motion = 0;
  for (std::size_t k = frame > 2 ? frame - 2 : 0; k < std::min(frame + 2, size() - 1); ++k)
    motion = std::max(motion, mesh_motion(meshes, k));
  const double reach = kReach * spacing_ + kReachOfMotion * motion;
  return std::make_shared<DistanceImage>(signed_distances(meshes.frame(frame).surface, spacing_, reach),
                                         time(frame));
}

/// From a frame to the next: the distance from the one mesh that no vertex of the other exceeds.
double DistanceSequence::mesh_motion(const MeshSequence& meshes, std::size_t frame) {
  if (!motion_[frame]) {
    const SolidDistance from(meshes.frame(frame).surface);
    const std::vector<Vec3> to = meshes.frame(frame + 1).surface.vertices;
    motion_[frame] =
        parallel_max(to.size(), 0.0, [&](std::size_t v) { return std::abs(from.nearest(to[v]).distance); });
  }
  return *motion_[frame];
}

}  // namespace kappaflow
