#include "tools/io/input_frames.h"

#include <algorithm>
#include <iterator>
#include <system_error>
#include <utility>

#include "core/bytes.h"
#include "tools/io/near_surface.h"

namespace kappaflow {
namespace {

std::size_t bytes_in(const InputFrame& frame) {
  return bytes_of(frame.position, frame.id, frame.velocity, frame.density, frame.pressure, frame.temperature,
                  frame.source, frame.radius, frame.zone);
}

std::vector<std::int64_t> ids_that_go_on(const InputFrame& frame) {
  std::vector<std::int64_t> ids;
  for (std::size_t i = 0; i < frame.id.size(); ++i)
    if (frame.zone[i] != Zone::passing) ids.push_back(frame.id[i]);
  std::ranges::sort(ids);
  return ids;
}

}  // namespace

InputFrames::InputFrames(FileSeries series, std::size_t limit) : series_(std::move(series)), room_(limit) {}

InputFrame InputFrames::read(std::size_t frame) {
  if (ahead_.valid() && number_ahead_ == frame) return ahead_.get();
  if (ahead_.valid()) ahead_.wait();  // not every library may read two files at once
  if (sigma_ == 0) return read_input_frame(series_.files_of(frame));
  return read_near_surface(series_.files_of(frame), sigma_, ids_before(frame));
}

/// Where only particles near the surface are kept, frames are large: then only one is read at a time.
void InputFrames::read_ahead(std::size_t frame) {
  if (sigma_ > 0 || frame == series_.files.size() || is_here(frame)) return;
  const auto files = series_.files_of(frame);
  number_ahead_ = frame;
  try {
    ahead_ = std::async(std::launch::async,
                        [own = std::vector(files.begin(), files.end())] { return read_input_frame(own); });
  } catch (const std::system_error&) {
    ahead_ = {};  // no thread is to be had: then it is read when it is asked for
  }
}

/// Of the particles that go on from the frame before, ascending.
std::vector<std::int64_t> InputFrames::ids_before(std::size_t frame) {
  if (frame == 0) return {};
  for (const auto* frames : {&kept_, &last_})
    if (const auto found = frames->find(frame - 1); found != frames->end())
      return ids_that_go_on(found->second);
  return ids_that_go_on(read_near_surface(series_.files_of(frame - 1), sigma_, {}));
}

const InputFrame& InputFrames::operator[](std::size_t frame) {
  for (auto* frames : {&kept_, &last_})
    if (const auto found = frames->find(frame); found != frames->end()) return found->second;
  InputFrame now = read(frame);
  if (frame == 0 || frame == last_read_ + 1) read_ahead(frame + 1);
  last_read_ = frame;
  if (series_.backward)
    for (Vec3& velocity : now.velocity) velocity = -velocity;
  const std::size_t bytes = bytes_in(now);
  if (bytes <= room_) {
    room_ -= bytes;
    return kept_.emplace(frame, std::move(now)).first->second;
  }
  if (last_.size() == (sigma_ == 0 ? kWindow : kNearWindow)) {
    const auto lowest = last_.begin(), highest = std::prev(last_.end());
    const auto distance = [frame](std::size_t other) {
      return other < frame ? frame - other : other - frame;
    };
    last_.erase(distance(lowest->first) < distance(highest->first) ? highest : lowest);
  }
  return last_.emplace(frame, std::move(now)).first->second;
}

}  // namespace kappaflow
