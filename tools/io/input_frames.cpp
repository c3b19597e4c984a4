#include "tools/io/input_frames.h"

#include <utility>

#include "core/bytes.h"

namespace kappaflow {
namespace {

std::size_t bytes_in(const InputFrame& frame) {
  return bytes_of(frame.position, frame.id, frame.velocity, frame.density, frame.pressure, frame.temperature,
                  frame.source, frame.radius);
}

}  // namespace

InputFrames::InputFrames(FileSeries series, std::size_t limit) : series_(std::move(series)), room_(limit) {}

const InputFrame& InputFrames::operator[](std::size_t frame) {
  for (auto* frames : {&kept_, &last_})
    if (const auto found = frames->find(frame); found != frames->end()) return found->second;
  InputFrame read = read_input_frame(series_.files_of(frame));
  if (series_.backward)
    for (Vec3& velocity : read.velocity) velocity = -velocity;
  const std::size_t bytes = bytes_in(read);
  if (bytes <= room_) {
    room_ -= bytes;
    return kept_.emplace(frame, std::move(read)).first->second;
  }
  if (last_.size() == kWindow) last_.erase(last_.begin());
  return last_.emplace(frame, std::move(read)).first->second;
}

}  // namespace kappaflow
