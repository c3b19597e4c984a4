// What the first of several ranks says to the others, whatever its type.
#pragma once

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/saved_state.h"
#include "solver/ranks.h"

namespace kappaflow {

/// Gives all ranks the first one's values, of types that can be saved.
template <class... Values>
void broadcast_state(Ranks& ranks, Values&... values) {
  std::ostringstream written;
  if (ranks.rank() == 0) StateWriter(written, little_endian())(values...);
  const std::string text = std::move(written).str();
  std::vector<char> bytes(text.begin(), text.end());
  ranks.broadcast_values(bytes);
  if (ranks.rank() == 0) return;
  std::istringstream read(std::string(bytes.begin(), bytes.end()));
  StateReader archive(read);
  archive(values...);
}

}  // namespace kappaflow
