#include "tools/io/parallel_vtk.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

#include "core/errors.h"
#include "core/read_file.h"
#include "core/text_scanner.h"
#include "tools/io/vtk_xml.h"

namespace kappaflow {

namespace fs = std::filesystem;

namespace {

struct ParallelKind {
  std::string_view ending, ending_of_pieces, data;
};
constexpr std::array<ParallelKind, 3> kParallelKinds{
    {{".pvtp", ".vtp", "PolyData"}, {".pvtu", ".vtu", "UnstructuredGrid"}, {".pvti", ".vti", "ImageData"}}};

/// Null where the file is another.
const ParallelKind* parallel_kind(const fs::path& file) {
  const auto found =
      std::ranges::find(kParallelKinds, lower_case(file.extension().string()), &ParallelKind::ending);
  return found == kParallelKinds.end() ? nullptr : &*found;
}

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
  return parallel_kind(file) != nullptr;
}

fs::path piece_of(const fs::path& file, const std::string& source) {
  const std::string_view ending = parallel_kind(file)->ending_of_pieces;
  fs::path piece = piece_in(file.parent_path(), source);
  if (lower_case(piece.extension().string()) != ending)
    throw IoError(file.string(), fmt::format("its piece {} is no {}", one_line(source, 200), ending));
  if (std::error_code ignored; !fs::exists(piece, ignored))
    throw IoError(file.string(), fmt::format("its piece {} is not there", one_line(piece.string(), 400)));
  return piece;
}

std::vector<fs::path> pieces_of(const fs::path& file) {
  const ParallelKind* const kind = parallel_kind(file);
  if (kind == nullptr) return {file};
  const std::string bytes = read_file(file);
  std::vector<std::string> sources;
  try {
    sources = parse_vtk_pieces(bytes, kind->data);
  } catch (const InvalidInput& error) {
    throw IoError(file.string(), fmt::format("is damaged or not complete ({})", error.what()));
  }
  std::vector<fs::path> pieces;
  pieces.reserve(sources.size());
  for (const std::string& source : sources) pieces.push_back(piece_of(file, source));
  return pieces;
}

}  // namespace kappaflow
