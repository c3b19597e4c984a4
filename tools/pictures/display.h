// Whether there is something to draw on. Apart from picture.cpp because X11's macros break Eigen's headers.
#pragma once

namespace kappaflow {

/// Whether the X server that DISPLAY names can be reached.
bool has_display();

/// From now on who draws waits for ever where the X server is gone, instead of ending the program with a
/// message: for when the program ends anyway, and the server first.
void wait_without_display();

}  // namespace kappaflow
