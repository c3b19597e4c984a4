#include "tools/runs/timings.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include "core/errors.h"
#include "core/read_file.h"
#include "tools/io/csv.h"
#include "tools/io/point_data.h"

namespace kappaflow {
namespace {

/// Of PhaseSeconds::surface() [ms].
constexpr std::array<std::string_view, 5> kSurfaceColumns{"velocity_ms", "fairing_ms", "topology_ms",
                                                          "remesh_ms", "texture_ms"};

SurfaceTime time_of(const std::vector<std::string_view>& cells, const std::vector<std::string_view>& names) {
  if (cells.size() != names.size()) throw InvalidInput("has not as many cells as the table has columns");
  SurfaceTime result;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (names[c] == "frame") result.frame = static_cast<int>(number_from(cells[c]));
    if (names[c] == "method") result.method = cells[c];
    if (std::ranges::count(kSurfaceColumns, names[c]) > 0) result.seconds += 1e-3 * number_from(cells[c]);
  }
  return result;
}

}  // namespace

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

std::vector<SurfaceTime> read_surface_times(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return {};
  const std::string text = read_file(file);
  std::size_t at = 0;
  const std::vector<std::string_view> names = csv_cells(line_at(text, at));
  if (names.size() < 3 || names[0] != "frame" || names[2] != "method")
    throw IoError(file.string(), "is not a table of times");
  std::vector<SurfaceTime> times;
  while (at < text.size()) try {
      times.push_back(time_of(csv_cells(line_at(text, at)), names));
    } catch (const InvalidInput& error) {
      throw IoError(file.string(), fmt::format("row {} {}", times.size() + 1, error.what()));
    }
  return times;
}

}  // namespace kappaflow
