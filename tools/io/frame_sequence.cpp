#include "tools/io/frame_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

#include "core/errors.h"
#include "core/text_hash.h"
#include "core/text_scanner.h"
#include "tools/io/frame_times.h"
#include "tools/io/image_pieces.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

void read(std::span<const fs::path> files, ImageFrame& frame) {
  frame = read_image(files);
}
void read(std::span<const fs::path> files, MeshFrame& frame) {
  frame = read_mesh_frame(files.front());  // meshes do not come in pieces
}

void turn_backward(ImageFrame& frame) {
  for (Eigen::Vector3f& velocity : frame.velocity) velocity = -velocity;
}
void turn_backward(MeshFrame& /*frame*/) {}

void add_to(TextHash& hash, const ImageFrame& frame) {
  hash.add_values(std::span<const int>(frame.dims));
  hash.add_values(std::span<const Vec3>(std::array{frame.origin, frame.spacing}));
  hash.add_values(std::span(frame.value));
  hash.add_values(std::span(frame.velocity));
}
void add_to(TextHash& hash, const MeshFrame& frame) {
  hash.add_values(std::span(frame.surface.vertices));
  hash.add_values(std::span(frame.surface.triangles));
}

std::string range_text(std::size_t fewest, std::size_t most, const char* what) {
  return fewest == most ? fmt::format("{} {}", most, what) : fmt::format("{} to {} {}", fewest, most, what);
}

/// What the frames have in common, as far as they have been added.
template <class Frame>
class Common;

template <>
class Common<ImageFrame> {
 public:
  void add(const ImageFrame& frame, const fs::path& file, const fs::path& first_file) {
    if (fewest_ == 0) {
      first_ = {frame.dims, frame.origin, frame.spacing};
      first_.name = frame.name;
      first_.velocity_name = frame.velocity_name;
    }
    check_like_first(frame, file, first_file);
    fewest_ = fewest_ == 0 ? frame.value.size() : std::min(fewest_, frame.value.size());
    most_ = std::max(most_, frame.value.size());
  }

  std::vector<std::string> notes() const {
    const Vec3& h = first_.spacing;
    const std::string points = fewest_ == most_ && same_points_
                                   ? fmt::format("{} points", fmt::join(first_.dims, " x "))
                                   : range_text(fewest_, most_, "points");
    return {fmt::format("{}, {:.6g} m apart", points,
                        fmt::join(h.data(), h.data() + (h.minCoeff() == h.maxCoeff() ? 1 : 3), " x ")),
            fmt::format("signed distances \"{}\"", first_.name),
            first_.velocity_name.empty() ? std::string("no velocities")
                                         : fmt::format("velocities from \"{}\"", first_.velocity_name)};
  }

 private:
  void check_like_first(const ImageFrame& frame, const fs::path& file, const fs::path& first_file) {
    if (frame.velocity_name.empty() != first_.velocity_name.empty()) {
      const bool lacks = frame.velocity_name.empty();
      throw InvalidInput(
          {(lacks ? file : first_file).string()},
          fmt::format("has no velocities; {} has them (\"{}\")", (lacks ? first_file : file).string(),
                      lacks ? first_.velocity_name : frame.velocity_name));
    }
    const bool same_points = frame.dims == first_.dims && frame.origin == first_.origin;
    same_points_ = same_points_ && same_points;
    const bool may_move = lower_case(file.extension().string()) == ".vdb";
    if (frame.spacing == first_.spacing && (same_points || may_move)) return;
    throw InvalidInput({file.string()},
                       fmt::format("has {}; {} has {}: the points must stay the same", lattice_text(frame),
                                   first_file.string(), lattice_text(first_)));
  }

  static std::string lattice_text(const ImageFrame& frame) {
    return fmt::format("{} points from ({:.6g}) on, ({:.6g}) apart", fmt::join(frame.dims, " x "),
                       fmt::join(frame.origin, ", "), fmt::join(frame.spacing, ", "));
  }

  ImageFrame first_;  // without values
  std::size_t fewest_ = 0, most_ = 0;
  bool same_points_ = true;
};

template <>
class Common<MeshFrame> {
 public:
  void add(const MeshFrame& frame, const fs::path& /*file*/, const fs::path& /*first_file*/) {
    triangles_.push_back(frame.surface.triangles.size());
  }
  std::vector<std::string> notes() const {
    const auto [fewest, most] = std::ranges::minmax(triangles_);
    return {range_text(fewest, most, "triangles")};
  }

 private:
  std::vector<std::size_t> triangles_;
};

}  // namespace

template <class Frame>
FrameSequence<Frame>::FrameSequence(FileSeries series, std::optional<double> frames_per_second,
                                    const std::function<void(std::size_t file)>& watch)
    : series_(std::move(series)) {
  FrameTimes times(series_);
  TextHash hash;
  Common<Frame> common;
  for (std::size_t k = 0; k < size(); ++k) {
    if (watch) watch(k);
    const Frame now = frame(k);
    common.add(now, file(k), file(0));
    times.add(now.time);
    const double time = now.time.value_or(0);
    hash.add_values(std::span(&time, 1));
    add_to(hash, now);
  }
  times.check_gap();
  hash_ = hash.text();
  time_ = times.times(frames_per_second);
  notes_ = common.notes();
  std::ranges::move(times.notes(frames_per_second), std::back_inserter(notes_));
}

template <class Frame>
Frame FrameSequence<Frame>::frame(std::size_t frame) const {
  Frame result;
  read(series_.files_of(frame), result);
  if (series_.backward) turn_backward(result);
  return result;
}

template class FrameSequence<ImageFrame>;
template class FrameSequence<MeshFrame>;

}  // namespace kappaflow
