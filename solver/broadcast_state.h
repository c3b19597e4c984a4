// What the first of several ranks says to the others, whatever its type.
#pragma once

#include <string>
#include <utility>

#include "core/state_bytes.h"
#include "solver/ranks.h"

namespace kappaflow {

/// Gives all ranks the first one's values, of types that can be saved.
template <class... Values>
void broadcast_state(Ranks& ranks, Values&... values) {
  std::string bytes;
  if (ranks.rank() == 0) bytes = state_bytes(values...);
  ranks.broadcast_values(bytes);
  if (ranks.rank() > 0) read_state_bytes(std::move(bytes), values...);
}

}  // namespace kappaflow
