#include "tools/io/parallel_vtk.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <system_error>

#include "core/errors.h"
#include "core/read_file.h"
#include "core/text_scanner.h"
#include "tools/io/vtk_xml.h"

namespace kappaflow {

namespace fs = std::filesystem;

namespace {

/// Windows parts folders by a backslash.
fs::path piece_in(const fs::path& folder, const std::string& source) {
  std::error_code ignored;
  if (fs::exists(folder / source, ignored)) return folder / source;
  std::string other = source;
  std::ranges::replace(other, '\\', '/');
  return folder / other;
}

}  // namespace

bool is_parallel_vtk(const fs::path& file) {
  const std::string ending = lower_case(file.extension().string());
  return ending == ".pvtp" || ending == ".pvtu";
}

std::vector<fs::path> pieces_of(const fs::path& file) {
  if (!is_parallel_vtk(file)) return {file};
  const bool polydata = lower_case(file.extension().string()) == ".pvtp";
  const char* const ending = polydata ? ".vtp" : ".vtu";
  const std::string bytes = read_file(file);
  std::vector<std::string> sources;
  try {
    sources = parse_vtk_pieces(bytes, polydata ? "PolyData" : "UnstructuredGrid");
  } catch (const InvalidInput& error) {
    throw IoError(file.string(), fmt::format("is damaged or not complete ({})", error.what()));
  }
  std::vector<fs::path> pieces;
  for (const std::string& source : sources) {
    const fs::path& piece = pieces.emplace_back(piece_in(file.parent_path(), source));
    if (lower_case(piece.extension().string()) != ending)
      throw IoError(file.string(), fmt::format("its piece {} is no {}", one_line(source, 200), ending));
    if (std::error_code ignored; !fs::exists(piece, ignored))
      throw IoError(file.string(), fmt::format("its piece {} is not there", one_line(piece.string(), 400)));
  }
  return pieces;
}

}  // namespace kappaflow
