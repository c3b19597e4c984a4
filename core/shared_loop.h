// Parallel loops of which several processes do a share each, to the bits that one process comes to.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "core/types.h"
#include "core/work_group.h"

namespace kappaflow {

/// The group that shares a loop over n elements; nullptr: none, or it is done sooner than told.
inline WorkGroup* sharing_group(std::size_t n) {
  constexpr std::size_t kFew = 512;
  return n < kFew ? nullptr : SharedWork::group();
}

/// Calls work(begin, end) for this process's share of n elements. Where it throws an Error in one of them,
/// all throw the first one's.
void do_share(WorkGroup& group, std::size_t n, const std::function<void(std::size_t, std::size_t)>& work);

/// Of n elements, how many are in the share of each process, times `factor`.
std::vector<std::size_t> share_sizes(const WorkGroup& group, std::size_t n, std::size_t factor);

/// One value an element, of which each process knows those of its share: from all.
template <class T>
void gather_shares(WorkGroup& group, std::span<T> values) {
  group.gather_in_place(share_sizes(group, values.size(), sizeof(T)), bytes_in(values));
}

/// parallel_for() of a loop that costs much for each element, and what becomes of element i is in the i-th
/// entries of `results`, of n each: the others' shares come from there. How the elements are cut into tasks
/// depends on the processes, so body should be no arithmetic that a compiler works on for several elements at
/// a time.
template <class Body, class... Results>
void shared_for(std::size_t n, const Body& body, std::size_t grain, Results&&... results) {
  const auto work = [&](std::size_t begin, std::size_t end) {
    parallel_for(
        end - begin, [&](std::size_t i) { body(begin + i); }, grain);
  };
  WorkGroup* const group = sharing_group(n);
  if (group == nullptr) return work(0, n);
  do_share(*group, n, work);
  (gather_shares(*group, std::span(results)), ...);
}

/// The same, with the largest of value(i), and at least `least`.
template <class Value, class... Results>
double shared_max(std::size_t n, double least, const Value& value, std::size_t grain, Results&&... results) {
  const auto largest = [&](std::size_t begin, std::size_t end) {
    return parallel_max(
        end - begin, least, [&](std::size_t i) { return value(begin + i); }, grain);
  };
  WorkGroup* const group = sharing_group(n);
  if (group == nullptr) return largest(0, n);
  const std::size_t size = static_cast<std::size_t>(group->size());
  std::vector<double> of_each(size, least);
  do_share(*group, n, [&](std::size_t begin, std::size_t end) {
    of_each[static_cast<std::size_t>(group->rank())] = largest(begin, end);
  });
  const std::vector<std::size_t> sizes(size, sizeof(double));
  group->gather_in_place(sizes, bytes_in(std::span(of_each)));
  (gather_shares(*group, std::span(results)), ...);
  return std::ranges::max(of_each);
}

/// parallel_for() of a loop of few elements, a task each, of which body(i) fills lists[i], empty before.
template <class T, class Body>
void shared_lists(const Body& body, std::vector<std::vector<T>>& lists) {
  const std::size_t n = lists.size();
  const auto work = [&](std::size_t begin, std::size_t end) {
    parallel_for(
        end - begin, [&](std::size_t i) { body(begin + i); }, 1);
  };
  WorkGroup* const group = SharedWork::group();
  if (group == nullptr) return work(0, n);
  do_share(*group, n, work);
  std::vector<std::size_t> counts(n), sizes(static_cast<std::size_t>(group->size()), 0);
  for (std::size_t i = 0; i < n; ++i) counts[i] = lists[i].size();
  gather_shares(*group, std::span(counts));
  std::vector<T> all;
  for (int r = 0; r < group->size(); ++r)
    for (std::size_t i = group->share_begin(n, r); i < group->share_begin(n, r + 1); ++i) {
      sizes[static_cast<std::size_t>(r)] += sizeof(T) * counts[i];
      all.insert(all.end(), lists[i].begin(), lists[i].end());
      all.insert(all.end(), counts[i] - lists[i].size(), T{});
    }
  group->gather_in_place(sizes, bytes_in(std::span(all)));
  auto from = all.begin();
  for (std::size_t i = 0; i < n; ++i) {
    const auto end = from + static_cast<std::ptrdiff_t>(counts[i]);
    lists[i].assign(from, end);
    from = end;
  }
}

/// Elements of a loop, each of which some process works on.
class ItemShares {
 public:
  /// Of a loop that no group shares.
  ItemShares() = default;
  /// owner: the process of each element.
  ItemShares(WorkGroup& group, std::vector<int> owner);

  WorkGroup* group() const { return group_; }
  bool is_own(std::size_t i) const { return group_ == nullptr || owner_[i] == group_->rank(); }
  int owner(std::size_t i) const { return owner_[i]; }

  /// Shares of other elements, each with the process of one of these.
  ItemShares of(std::span<const int> elements) const;

  /// parallel_for() of those of n elements that are this process's. body must not throw.
  template <class Body>
  void for_own(std::size_t n, const Body& body, std::size_t grain) const {
    const std::span<const std::uint32_t> own = group_ == nullptr ? order_ : of_rank(group_->rank());
    parallel_for(
        group_ == nullptr ? n : own.size(),
        [&](std::size_t k) { body(own.empty() ? k : std::size_t{own[k]}); }, grain);
  }

  /// One value an element, of which each process knows its own: from all.
  template <class T>
  void gather(std::span<T> values) const {
    if (group_ == nullptr) return;
    const std::size_t begin = begin_[group_->rank()];
    const std::span<const std::uint32_t> own = of_rank(group_->rank());
    std::vector<T> all(values.size());
    parallel_for(own.size(), [&](std::size_t k) { all[begin + k] = values[own[k]]; });
    std::vector<std::size_t> sizes;
    sizes.reserve(begin_.size());
    for (int r = 0; r < group_->size(); ++r) sizes.push_back(sizeof(T) * of_rank(r).size());
    group_->gather_in_place(sizes, bytes_in(std::span(all)));
    parallel_for(all.size(), [&](std::size_t k) { values[order_[k]] = all[k]; });
  }

 private:
  std::span<const std::uint32_t> of_rank(int r) const {
    return std::span(order_).subspan(begin_[r], begin_[r + 1] - begin_[r]);
  }

  WorkGroup* group_ = nullptr;
  std::vector<int> owner_;
  std::vector<std::uint32_t> order_;  // all elements, by process
  std::vector<std::size_t> begin_;    // of a process in order_
};

/// Points in slabs across the longest side of the box around them, a slab a process, with as many points as
/// its share says: so most of what is near a point is the same process's.
ItemShares shares_in_slabs(std::span<const Vec3> points);

}  // namespace kappaflow
