#include "core/suggestion.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace kappaflow {
namespace {

/// The least number of characters to insert, delete or replace that turns a into b (Levenshtein 1966).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string suggestion(std::string_view found, std::span<const std::string_view> names) {
  constexpr std::size_t kMostNames = 3;  // more that are as near would be a guess
  std::vector<std::string> nearest;
  std::size_t least = std::max<std::size_t>(2, found.size() / 3);
  for (const std::string_view name : names) {
    const std::size_t distance = edit_distance(found, name);
    if (distance > least) continue;
    if (distance < least) nearest.clear();
    least = distance;
    nearest.push_back(fmt::format("\"{}\"", name));
  }
  if (nearest.empty() || nearest.size() > kMostNames) return {};
  return fmt::format(" (did you mean {}?)", fmt::join(nearest, " or "));
}

}  // namespace kappaflow
