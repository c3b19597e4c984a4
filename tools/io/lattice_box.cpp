#include "tools/io/lattice_box.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace kappaflow {
namespace {

/// Adds what a part leaves of the box, as up to six boxes.
void add_remainder(LatticeBox box, const LatticeBox& part, std::vector<LatticeBox>& left) {
  if (box.common_with(part).empty()) {
    left.push_back(box);
    return;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    LatticeBox before = box, behind = box;
    before.last[c] = part.first[c] - 1;
    behind.first[c] = part.last[c] + 1;
    if (!before.empty()) left.push_back(before);
    if (!behind.empty()) left.push_back(behind);
    box.first[c] = std::max(box.first[c], part.first[c]);
    box.last[c] = std::min(box.last[c], part.last[c]);
  }
}

}  // namespace

bool LatticeBox::empty() const {
  return first[0] > last[0] || first[1] > last[1] || first[2] > last[2];
}

std::array<std::size_t, 3> LatticeBox::points() const {
  std::array<std::size_t, 3> count{};
  for (std::size_t c = 0; c < 3; ++c) count[c] = static_cast<std::size_t>(last[c] - first[c] + 1);
  return count;
}

std::size_t LatticeBox::index(std::int64_t i, std::int64_t j, std::int64_t k) const {
  const std::array<std::size_t, 3> count = points();
  return (static_cast<std::size_t>(k - first[2]) * count[1] + static_cast<std::size_t>(j - first[1])) *
             count[0] +
         static_cast<std::size_t>(i - first[0]);
}

bool LatticeBox::contains(const LatticeBox& part) const {
  return part.empty() || part.common_with(*this) == part;
}

LatticeBox LatticeBox::common_with(const LatticeBox& other) const {
  LatticeBox common = *this;
  for (std::size_t c = 0; c < 3; ++c) {
    common.first[c] = std::max(first[c], other.first[c]);
    common.last[c] = std::min(last[c], other.last[c]);
  }
  return common;
}

std::optional<LatticeBox> gap_between(const LatticeBox& whole, std::span<const LatticeBox> parts) {
  std::vector<LatticeBox> open;
  if (!whole.empty()) open.push_back(whole);
  for (const LatticeBox& part : parts) {
    std::vector<LatticeBox> left;
    for (const LatticeBox& box : open) add_remainder(box, part, left);
    open = std::move(left);
  }
  return open.empty() ? std::nullopt : std::optional(open.front());
}

}  // namespace kappaflow
