#include "tools/display.h"

#include <X11/Xlib.h>

namespace kappaflow {

bool has_display() {
  Display* display = XOpenDisplay(nullptr);
  if (display == nullptr) return false;
  XCloseDisplay(display);
  return true;
}

}  // namespace kappaflow
