// Drawing on machines without a display.
#pragma once

namespace kappaflow {

/// Makes sure of a display for the rest of the program: where there is none, starts this very command line
/// anew under xvfb-run (a virtual X server), in the same process, and does not return. Throws IoError where
/// that fails, e.g. when xvfb-run is not installed.
void ensure_display(char** argv);

}  // namespace kappaflow
