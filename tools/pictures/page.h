// `kappaflow page`: a run as one HTML file in which one plays its frames and compares its methods.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kappaflow {

struct PageOptions {
  std::filesystem::path folder;      ///< of a run
  std::filesystem::path out;         ///< .html; empty: page.html in the run folder
  std::vector<std::string> methods;  ///< empty: all of the run
};

/// Writes the page, which needs neither server nor network: programs, surfaces, walls and metrics are in it.
/// Positions and rest positions have 16 bits across the boxes around them, normals and what colours surfaces
/// have 8. Returns what to print: the file, its size, and the address that browsers open it by. Throws
/// InvalidInput (no such method, no frames), IoError (not a run folder, a damaged file, not writable).
std::string write_page(const PageOptions& options);

}  // namespace kappaflow
