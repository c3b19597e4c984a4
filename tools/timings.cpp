#include "tools/timings.h"

#include <fmt/format.h>

namespace kappaflow {

std::string timings_header() {
  return "frame,time,method,solver_ms,velocity_ms,fairing_ms,topology_ms,remesh_ms,output_ms\n";
}

std::string timings_row(int frame, double time, const std::string& method, const PhaseSeconds& seconds) {
  return fmt::format("{},{:.12g},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", frame, time, method,
                     1e3 * seconds.solver, 1e3 * seconds.velocity, 1e3 * seconds.fairing,
                     1e3 * seconds.topology, 1e3 * seconds.remesh, 1e3 * seconds.output);
}

}  // namespace kappaflow
