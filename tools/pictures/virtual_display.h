// Drawing on machines without a display.
#pragma once

namespace kappaflow {

/// A display for as long as it lives: the one that DISPLAY names, or where that cannot be reached an X server
/// without a screen (Xvfb), which ends with the program, however that ends. From its making on SIGINT and
/// SIGTERM end the program at once (end_at_once_on_signals()).
class VirtualDisplay {
 public:
  /// To be made by the program's first thread while it is the only one. Throws IoError where there is no
  /// display and none can be made, e.g. when Xvfb is not installed.
  VirtualDisplay();
  ~VirtualDisplay();
  VirtualDisplay(const VirtualDisplay&) = delete;
  VirtualDisplay& operator=(const VirtualDisplay&) = delete;
};

}  // namespace kappaflow
