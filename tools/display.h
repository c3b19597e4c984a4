// Whether there is something to draw on. Apart from picture.cpp because X11's macros break Eigen's headers.
#pragma once

namespace kappaflow {

/// Whether the X server that DISPLAY names can be reached.
bool has_display();

}  // namespace kappaflow
