// Parallel loops and reductions that give the same bits whatever the number of threads.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/partitioner.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

#include "core/work_group.h"

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace kappaflow {

/// Tells the thread sanitizer, which does not see into Debian's oneTBB, that the tasks of a loop come after
/// what was done before the loop, and before what is done after it. Between tasks it orders nothing.
#ifdef __SANITIZE_THREAD__
class TaskOrder {
 public:
  TaskOrder() { __tsan_release(&fork_); }
  void begin_task() { __tsan_acquire(&fork_); }
  void end_task() { __tsan_release(&join_); }
  void join() { __tsan_acquire(&join_); }

 private:
  char fork_ = 0, join_ = 0;  // only their addresses matter
};
#else
struct TaskOrder {
  void begin_task() const {}
  void end_task() const {}
  void join() const {}
};
#endif

/// How many threads may work on a loop. Results must not depend on it.
inline int parallel_threads() {
  const std::size_t allowed = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  return std::min(tbb::this_task_arena::max_concurrency(), static_cast<int>(allowed));
}

/// Elements that a task works on when the caller does not say; also fixes the summation tree of the
/// reductions.
inline constexpr std::size_t kDefaultGrain = 256;

/// Calls body(i) for i in [0, n), each exactly once, in parallel. body must write to element i only. How the
/// elements are cut into tasks depends on n and grain only: a compiler may round the first and last elements
/// of a loop in another way than those between, which it works on several at a time.
template <class Body>
void parallel_for(std::size_t n, const Body& body, std::size_t grain = kDefaultGrain) {
  const SharedWork none(nullptr);
  TaskOrder order;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, n, grain),
      [&](const tbb::blocked_range<std::size_t>& range) {
        order.begin_task();
        for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
        order.end_task();
      },
      tbb::simple_partitioner());
  order.join();
}

/// combine over i in [0, n) of value(i), starting from identity. The tree of combinations depends on n and
/// grain only, never on the threads, so floating-point results are reproducible.
template <class T, class Value, class Combine>
T parallel_reduce(std::size_t n, const T& identity, const Value& value, const Combine& combine,
                  std::size_t grain = kDefaultGrain) {
  const SharedWork none(nullptr);
  TaskOrder order;
  T result = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, n, grain), identity,
      [&](const tbb::blocked_range<std::size_t>& range, T partial) {
        order.begin_task();
        for (std::size_t i = range.begin(); i != range.end(); ++i) partial = combine(partial, value(i));
        order.end_task();
        return partial;
      },
      combine);
  order.join();
  return result;
}

/// Sum over i in [0, n) of value(i), reproducible. T: a number or an Eigen vector's plain type.
template <class T, class Value>
T parallel_sum(std::size_t n, const T& zero, const Value& value, std::size_t grain = kDefaultGrain) {
  return parallel_reduce(
      n, zero, value, [](const T& a, const T& b) -> T { return a + b; }, grain);
}

/// Maximum over i in [0, n) of value(i), and at least `least`.
template <class T, class Value>
T parallel_max(std::size_t n, const T& least, const Value& value, std::size_t grain = kDefaultGrain) {
  return parallel_reduce(
      n, least, value, [](const T& a, const T& b) -> T { return std::max(a, b); }, grain);
}

}  // namespace kappaflow
