// Values as the bytes of an archive, see saved_state.h, and back.
#pragma once

#include <sstream>
#include <string>
#include <utility>

#include "core/saved_state.h"

namespace kappaflow {

/// Of what write(archive) saves.
template <class Write>
std::string bytes_written(const Write& write) {
  std::ostringstream bytes;
  StateWriter archive(bytes, little_endian());
  write(archive);
  return std::move(bytes).str();
}

template <class... Values>
std::string state_bytes(const Values&... values) {
  return bytes_written([&](StateWriter& archive) { archive(values...); });
}

/// read(archive), of these bytes. Throws what cereal throws where there are fewer.
template <class Read>
void read_bytes(std::string bytes, const Read& read) {
  std::istringstream text(std::move(bytes));
  StateReader archive(text);
  read(archive);
}

template <class... Values>
void read_state_bytes(std::string bytes, Values&... values) {
  read_bytes(std::move(bytes), [&](StateReader& archive) { archive(values...); });
}

}  // namespace kappaflow
