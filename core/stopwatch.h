// Wall time.
#pragma once

#include <chrono>
#include <utility>

namespace kappaflow {

/// Seconds since it was made.
class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  /// Seconds since the last call of lap(), or since it was made.
  double lap() {
    const double before = std::exchange(lap_, seconds());
    return lap_ - before;
  }

 private:
  double lap_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// How long work() takes [s].
template <class Work>
double seconds_of(const Work& work) {
  const Stopwatch watch;
  work();
  return watch.seconds();
}

}  // namespace kappaflow
