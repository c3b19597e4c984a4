// Ctrl-C and the signal to end: the work stops at the next good moment instead of at once.
#pragma once

namespace kappaflow {

/// As shells have it: 130 for SIGINT, 143 for SIGTERM.
inline int exit_code_after(int signal) {
  return 128 + signal;
}

/// Catches SIGINT and SIGTERM for as long as it lives; a second one ends the program at once.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  /// The signal that came since the guard was made; 0: none.
  int signal() const;
  bool interrupted() const { return signal() != 0; }

 private:
  void (*previous_int_)(int);
  void (*previous_term_)(int);
};

/// From now on SIGINT and SIGTERM end the program at once, after `clean_up`, which another thread calls; no
/// InterruptGuard hears of them. To be called by the first thread while it is the only one: threads that come
/// later leave the signals to that other one, as it does.
void end_at_once_on_signals(void (*clean_up)());

}  // namespace kappaflow
