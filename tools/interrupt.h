// Ctrl-C: the work stops at the next good moment instead of at once.
#pragma once

namespace kappaflow {

inline constexpr int kExitInterrupted = 130;  ///< 128 + SIGINT, as shells have it

/// Catches SIGINT for as long as it lives; a second one ends the program at once.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  /// Whether SIGINT came since the guard was made.
  bool interrupted() const;

 private:
  void (*previous_)(int);
};

}  // namespace kappaflow
