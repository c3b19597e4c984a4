// Values as the bytes of an archive, see saved_state.h, and back.
#pragma once

#include <sstream>
#include <string>
#include <utility>

#include "core/saved_state.h"

namespace kappaflow {

template <class... Values>
std::string state_bytes(const Values&... values) {
  std::ostringstream bytes;
  StateWriter(bytes, little_endian())(values...);
  return std::move(bytes).str();
}

/// Throws what cereal throws where there are fewer bytes.
template <class... Values>
void read_state_bytes(std::string bytes, Values&... values) {
  std::istringstream text(std::move(bytes));
  StateReader archive(text);
  archive(values...);
}

}  // namespace kappaflow
