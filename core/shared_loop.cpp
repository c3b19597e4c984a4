#include "core/shared_loop.h"

#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "core/errors.h"

namespace kappaflow {
namespace {

/// What became of a process's share.
struct Outcome {
  int exit_code = 0;  // of its Error; 0: none
  std::size_t length = 0;
};

}  // namespace

void do_share(WorkGroup& group, std::size_t n, const std::function<void(std::size_t, std::size_t)>& work) {
  const std::size_t rank = static_cast<std::size_t>(group.rank());
  std::vector<Outcome> outcomes(static_cast<std::size_t>(group.size()));
  std::string text;
  try {
    work(group.share_begin(n, group.rank()), group.share_begin(n, group.rank() + 1));
  } catch (const Error& error) {
    text = error.what();
    outcomes[rank] = {error.exit_code(), text.size()};
  }
  std::vector<std::size_t> sizes(outcomes.size(), sizeof(Outcome));
  group.gather_in_place(sizes, bytes_in(std::span(outcomes)));
  const auto failed = [](const Outcome& outcome) { return outcome.exit_code != 0; };
  const auto first = std::ranges::find_if(outcomes, failed);
  if (first == outcomes.end()) return;
  const bool is_own = first == outcomes.begin() + group.rank();
  std::string told = is_own ? text : std::string(first->length, '\0');
  std::ranges::fill(sizes, 0);
  sizes[static_cast<std::size_t>(first - outcomes.begin())] = first->length;
  group.gather_in_place(sizes, bytes_in(std::span(told)));
  throw_told(told, first->exit_code);
}

std::vector<std::size_t> share_sizes(const WorkGroup& group, std::size_t n, std::size_t factor) {
  std::vector<std::size_t> sizes;
  sizes.reserve(static_cast<std::size_t>(group.size()));
  for (int r = 0; r < group.size(); ++r)
    sizes.push_back(factor * (group.share_begin(n, r + 1) - group.share_begin(n, r)));
  return sizes;
}

ItemShares::ItemShares(WorkGroup& group, std::vector<int> owner)
    : group_(&group), owner_(std::move(owner)), order_(owner_.size()) {
  begin_.assign(static_cast<std::size_t>(group.size()) + 1, 0);
  for (const int r : owner_) ++begin_[r + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  std::vector<std::size_t> end(begin_.begin(), begin_.end() - 1);
  for (std::size_t i = 0; i < owner_.size(); ++i) order_[end[owner_[i]]++] = static_cast<std::uint32_t>(i);
}

ItemShares ItemShares::of(std::span<const int> elements) const {
  if (group_ == nullptr) return {};
  std::vector<int> owner;
  owner.reserve(elements.size());
  for (const int i : elements) owner.push_back(owner_[i]);
  return {*group_, std::move(owner)};
}

ItemShares shares_in_slabs(std::span<const Vec3> points) {
  WorkGroup* const group = sharing_group(points.size());
  if (group == nullptr) return {};
  Vec3 lower = points[0], upper = points[0];
  for (const Vec3& x : points) lower = lower.cwiseMin(x), upper = upper.cwiseMax(x);
  int axis = 0;
  (upper - lower).maxCoeff(&axis);
  std::vector<std::pair<double, std::uint32_t>> order(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    order[i] = {std::isfinite(points[i][axis]) ? points[i][axis] : 0, static_cast<std::uint32_t>(i)};
  std::vector<int> owner(points.size(), 0);
  const auto place = [&](int r) {
    return order.begin() + static_cast<std::ptrdiff_t>(group->share_begin(points.size(), r));
  };
  for (int r = 1; r < group->size(); ++r) {
    std::nth_element(place(r - 1), place(r), order.end());
    for (auto k = place(r); k != order.end(); ++k) owner[k->second] = r;
  }
  return {*group, std::move(owner)};
}

}  // namespace kappaflow
