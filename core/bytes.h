// How much memory arrays take.
#pragma once

#include <cstddef>
#include <vector>

namespace kappaflow {

/// What the arrays have set aside [bytes].
template <class... T>
std::size_t bytes_of(const std::vector<T>&... arrays) {
  return (std::size_t{0} + ... + (arrays.capacity() * sizeof(T)));
}

}  // namespace kappaflow
