// Sets as ascending lists.
#pragma once

#include <algorithm>
#include <vector>

namespace kappaflow {

/// Sorts the values and leaves one of each.
template <class T>
void sort_unique(std::vector<T>& values) {
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace kappaflow
