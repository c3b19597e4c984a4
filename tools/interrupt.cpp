#include "tools/interrupt.h"

#include <csignal>

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

}  // namespace kappaflow
