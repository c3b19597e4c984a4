#include "tools/interrupt.h"

#include <csignal>

namespace kappaflow {
namespace {

volatile std::sig_atomic_t interrupt_came = 0;

}  // namespace

InterruptGuard::InterruptGuard() {
  interrupt_came = 0;
  previous_ = std::signal(SIGINT, [](int) {
    interrupt_came = 1;
    std::signal(SIGINT, SIG_DFL);
  });
}

InterruptGuard::~InterruptGuard() {
  std::signal(SIGINT, previous_);
}

bool InterruptGuard::interrupted() const {
  return interrupt_came != 0;
}

}  // namespace kappaflow
