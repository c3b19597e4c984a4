#include "core/text_hash.h"

#include <fmt/format.h>

namespace kappaflow {

std::string TextHash::text() const {
  return fmt::format("fnv1a64:{:016x}", hash_);
}

std::string text_hash(std::string_view text) {
  return TextHash().add(text).text();
}

}  // namespace kappaflow
