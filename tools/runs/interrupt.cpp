#include "tools/runs/interrupt.h"

#include <csignal>
#include <cstdlib>
#include <thread>

namespace kappaflow {
namespace {

volatile std::sig_atomic_t signal_that_came = 0;

void remember(int signal) {
  signal_that_came = signal;
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  signal_that_came = 0;
  previous_int_ = std::signal(SIGINT, remember);
  previous_term_ = std::signal(SIGTERM, remember);
}

InterruptGuard::~InterruptGuard() {
  std::signal(SIGINT, previous_int_);
  std::signal(SIGTERM, previous_term_);
}

int InterruptGuard::signal() const {
  return signal_that_came;
}

void end_at_once_on_signals(void (*clean_up)()) {
  std::signal(SIGINT, SIG_DFL);  // one that is ignored does not come to sigwait() either
  std::signal(SIGTERM, SIG_DFL);
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals, clean_up] {
    int signal = 0;
    sigwait(&signals, &signal);
    clean_up();
    std::_Exit(exit_code_after(signal));
  }).detach();
}

}  // namespace kappaflow
