// An object that works without the interpreter's lock.
#pragma once

#include <fmt/format.h>
#include <nanobind/nanobind.h>

#include <atomic>

#include "core/errors.h"

namespace kappaflow::python {

/// Other Python threads run while it works; those that want the same object are refused, for the libraries'
/// objects are for one thread at a time.
template <class T>
class Exclusive {
 public:
  /// name: how its errors begin; make(): the object.
  template <class Make>
  Exclusive(const char* name, const Make& make) : name_(name), object_(without_lock(make)) {}

  /// work(T&), whatever has happened before. Throws InvalidInput where the object is at work already, in
  /// another thread or in a function that it has called.
  template <class Work>
  auto look(const Work& work) {
    const Turn turn(*this);
    return without_lock([&] { return work(object_); });
  }

  /// The same of an object that has not failed. Throws InvalidInput where it has.
  template <class Work>
  auto use(const Work& work) {
    return look([&](T& object) {
      if (failed_) throw InvalidInput(fmt::format("{}: it failed before, and can go no further", name_));
      return work(object);
    });
  }

  /// work(T&), which moves it on: one that fails on the way can go no further.
  template <class Work>
  auto move_on(const Work& work) {
    return use([&](T& object) {
      try {
        return work(object);
      } catch (...) {
        failed_ = true;
        throw;
      }
    });
  }

 private:
  class Turn {
   public:
    explicit Turn(Exclusive& of) : busy_(of.busy_) {
      if (busy_.test_and_set())
        throw InvalidInput(fmt::format(
            "{}: it is at work, in another thread or for the velocity method that asks; one at a time",
            of.name_));
    }
    ~Turn() { busy_.clear(); }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    std::atomic_flag& busy_;
  };

  template <class Work>
  static auto without_lock(const Work& work) {
    const nanobind::gil_scoped_release other_threads;
    return work();
  }

  const char* name_;
  T object_;
  bool failed_ = false;
  std::atomic_flag busy_;
};

}  // namespace kappaflow::python
