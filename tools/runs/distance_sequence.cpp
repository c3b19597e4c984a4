#include "tools/runs/distance_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/parallel.h"
#include "core/quantile.h"
#include "core/solid_distance.h"
#include "core/solids.h"
#include "surface/mesh/mesh_distances.h"

namespace kappaflow {
namespace {

constexpr std::size_t kImagesKept = 4;  // of a motion: two, and those around them

// The distances of meshes reach as many spacings of the grid, and so many times as far as a surface moves
// from a frame to the next: where it is two frames later they still have to say how far away it was. No
// further than kFarthestReach spacings: what goes beyond is rather a piece that appears or vanishes.
constexpr double kReach = 5, kReachOfMotion = 2.5, kFarthestReach = 40;
constexpr double kShareOfMotion = 0.99;  // of a mesh's vertices, that says how far it moves

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
  std::size_t p = 0;
  for (int k = 0; k < image.dims[2]; ++k)
    for (int j = 0; j < image.dims[1]; ++j)
      for (int i = 0; i < image.dims[0]; ++i, ++p) {
        const bool at_border = i == 0 || j == 0 || k == 0 || i == image.dims[0] - 1 ||
                               j == image.dims[1] - 1 || k == image.dims[2] - 1;
        if (image.value[p] >= 0 && at_border) return false;
        any_positive = any_positive || image.value[p] > 0;
      }
  return any_positive;
}

/// How far most of a surface's vertices are from another surface [m].
double distance_between(const TriangleSurface& surface, const SolidDistance& other) {
  std::vector<double> distance(surface.vertices.size());
  parallel_for(distance.size(),
               [&](std::size_t v) { distance[v] = std::abs(other.nearest(surface.vertices[v]).distance); });
  return quantile(distance, kShareOfMotion);
}

}  // namespace

DistanceSequence::DistanceSequence(const FileSeries& series, InputKind kind,
                                   std::optional<double> frames_per_second,
                                   const std::function<void(std::size_t file)>& watch)
    : frames_(kind == InputKind::images ? decltype(frames_)(ImageSequence(series, frames_per_second, watch))
                                        : decltype(frames_)(MeshSequence(series, frames_per_second, watch))) {
  notes_ = std::visit([](const auto& frames) { return frames.notes(); }, frames_);
  if (const auto* images = std::get_if<ImageSequence>(&frames_))
    take_images(*images);
  else
    take_meshes(std::get<MeshSequence>(frames_));
}

void DistanceSequence::take_images(const ImageSequence& images) {
  const ImageFrame first = images.frame(0);
  origin_ = first.origin;
  spacing_ = first.spacing.maxCoeff();
  has_velocity_ = !first.velocity.empty();
  positive_inside_ = is_positive_inside(first);
  if (positive_inside_) notes_.emplace_back("negative all around: positive is taken for inside");
  if (std::ranges::none_of(first.value, [&](float d) { return positive_inside_ ? d > 0 : d < 0; }))
    throw InvalidInput({images.file(0).string()},
                       "has nothing inside, no distance below 0; begin with a frame that has, by --frames");
}

void DistanceSequence::take_meshes(const MeshSequence& meshes) {
  std::optional<SolidDistance> before;
  TriangleSurface surface_before;
  double motion = 0;
  for (std::size_t k = 0; k < meshes.size(); ++k) try {
      TriangleSurface surface = meshes.frame(k).surface;
      if (k == 0) spacing_ = mean_edge(surface);
      check_crossings(surface);
      SolidDistance now(surface);
      if (before)
        motion =
            std::max({motion, distance_between(surface, *before), distance_between(surface_before, now)});
      before.emplace(std::move(now));
      surface_before = std::move(surface);
    } catch (const InvalidInput& error) {
      throw InvalidInput({meshes.file(k).string()}, error.what());
    }
  reach_ = std::min(kReach * spacing_ + kReachOfMotion * motion, kFarthestReach * spacing_);
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
  try {
    if (const auto* images = std::get_if<ImageSequence>(&frames_))
      images_.emplace_back(frame, make_image(images->frame(frame), time(frame)));
    else
      images_.emplace_back(
          frame, std::make_shared<DistanceImage>(
                     signed_distances(std::get<MeshSequence>(frames_).frame(frame).surface, spacing_, reach_),
                     time(frame)));
  } catch (const InvalidInput& error) {
    throw InvalidInput({series().files[frame].string()}, error.what());
  }
  if (images_.size() > kImagesKept) images_.pop_front();
  return images_.back().second;
}

DistanceMotion::Image DistanceSequence::make_image(ImageFrame frame, double time) const {
  SignedDistances distances{.grid = {.origin = origin_, .spacing = frame.spacing, .dims = frame.dims},
                            .value = std::move(frame.value),
                            .velocity = std::move(frame.velocity)};
  for (int a = 0; a < 3; ++a) {
    constexpr double kFarthest = 1e9, kTolerance = 1e-3;
    const double first = (frame.origin[a] - origin_[a]) / frame.spacing[a];
    if (!(std::abs(first) < kFarthest) || std::abs(first - std::round(first)) > kTolerance)
      throw InvalidInput(
          fmt::format("its points are not on the grid of the first file: they begin {} spacings "
                      "from it along an axis; expected a whole number",
                      first));
    distances.grid.first[a] = static_cast<int>(std::round(first));
  }
  if (positive_inside_)
    for (float& value : distances.value) value = -value;
  return std::make_shared<DistanceImage>(distances, time);
}

}  // namespace kappaflow
