// Numbers in binary files.
#pragma once

#include <bit>
#include <cstring>
#include <string>

namespace kappaflow {

/// Appends a number as little-endian bytes.
template <class Number>
void append(std::string& bytes, Number number) {
  static_assert(std::endian::native == std::endian::little, "files are written as memory has them");
  const std::size_t end = bytes.size();
  bytes.resize(end + sizeof number);
  std::memcpy(bytes.data() + end, &number, sizeof number);
}

}  // namespace kappaflow
