// Processes that compute the same, and share the work of their long loops.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <utility>

namespace kappaflow {

/// Bytes to or from another process.
struct Parcel {
  int rank = 0;
  std::span<std::byte> bytes;
};

template <class T>
std::span<std::byte> bytes_in(std::span<T> values) {
  return {reinterpret_cast<std::byte*>(values.data()), values.size_bytes()};
}
template <class T>
std::span<const std::byte> bytes_in(std::span<const T> values) {
  return {reinterpret_cast<const std::byte*>(values.data()), values.size_bytes()};
}

/// Processes, numbered from 0, that call the functions in the same order.
class WorkGroup {
 public:
  virtual ~WorkGroup() = default;

  virtual int rank() const = 0;
  virtual int size() const = 0;

  /// all: what every process has, in their order; sizes: of each one's [bytes]. Each has put its own there.
  virtual void gather_in_place(std::span<const std::size_t> sizes, std::span<std::byte> all) = 0;
  /// Sends and receives, at most one parcel each way between two processes, of the size that both know.
  /// Until what is received has come: meanwhile(), which exchanges nothing itself.
  virtual void exchange(std::span<const Parcel> sent, std::span<const Parcel> received,
                        const std::function<void()>& meanwhile) = 0;
  void exchange(std::span<const Parcel> sent, std::span<const Parcel> received) {
    exchange(sent, received, [] {});
  }

  /// Of n elements, where the share of a process begins; of rank size() their end.
  virtual std::size_t share_begin(std::size_t n, int rank) const {
    return n * static_cast<std::size_t>(rank) / static_cast<std::size_t>(size());
  }
};

/// While it lives, a group shares the loops of core/shared_loop.h that this thread begins: all its processes
/// are at the same, with the same data. Inside a parallel loop nothing is shared: what a process is at there
/// the others need not be.
class SharedWork {
 public:
  /// nullptr: nothing is shared, whatever was before.
  explicit SharedWork(WorkGroup* group) : before_(std::exchange(current_, group)) {}
  SharedWork(const SharedWork&) = delete;
  SharedWork& operator=(const SharedWork&) = delete;
  ~SharedWork() { current_ = before_; }

  static WorkGroup* group() { return current_; }

 private:
  static inline thread_local WorkGroup* current_ = nullptr;
  WorkGroup* before_;
};

}  // namespace kappaflow
