#include "tools/pictures/display.h"

#include <X11/Xlib.h>
#include <unistd.h>

namespace kappaflow {

bool has_display() {
  // Never closed: a virtual X server starts anew when its last client leaves, and refuses the next one while
  // it does so.
  static Display* display = nullptr;
  if (display == nullptr) display = XOpenDisplay(nullptr);
  return display != nullptr;
}

void wait_without_display() {
  XSetIOErrorHandler([](Display*) -> int {
    while (true) pause();
  });
}

}  // namespace kappaflow
