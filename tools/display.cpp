#include "tools/display.h"

#include <X11/Xlib.h>

namespace kappaflow {

bool has_display() {
  // Never closed: a virtual X server starts anew when its last client leaves, and refuses the next one while
  // it does so.
  static Display* const display = XOpenDisplay(nullptr);
  return display != nullptr;
}

}  // namespace kappaflow
