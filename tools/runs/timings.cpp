#include "tools/runs/timings.h"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>

namespace kappaflow {

PhaseSeconds phase_seconds(const TrackerStep& steps, double solver, double output) {
  return {.solver = solver,
          .velocity = steps.velocity_seconds,
          .fairing = steps.fairing_seconds,
          .topology = steps.topology_seconds,
          .remesh = steps.remesh_seconds,
          .texture = steps.texture_seconds,
          .output = output};
}

// The second number of statm is the resident set, in pages.
double resident_memory() {
  double size = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024 * 1024);
}

std::string timings_header() {
  return "frame,time,method,solver_ms,velocity_ms,fairing_ms,topology_ms,remesh_ms,texture_ms,output_ms,"
         "memory_mib\n";
}

std::string timings_row(int frame, double time, const std::string& method, const PhaseSeconds& seconds,
                        double memory) {
  return fmt::format("{},{:.12g},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.1f}\n", frame, time,
                     method, 1e3 * seconds.solver, 1e3 * seconds.velocity, 1e3 * seconds.fairing,
                     1e3 * seconds.topology, 1e3 * seconds.remesh, 1e3 * seconds.texture,
                     1e3 * seconds.output, memory);
}

}  // namespace kappaflow
