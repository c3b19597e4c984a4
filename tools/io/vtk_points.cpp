#include "tools/io/vtk_points.h"

#include <fmt/format.h>

#include <string>

#include "core/errors.h"
#include "core/read_file.h"
#include "tools/io/legacy_vtk.h"
#include "tools/io/vtk_xml.h"

namespace kappaflow {

PointData read_vtk_points(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  const char last = file.native().back();
  try {
    if (last == 'k' || last == 'K') return parse_legacy_vtk(bytes);
    return parse_vtk_xml(bytes, last == 'p' || last == 'P' ? "PolyData" : "UnstructuredGrid");
  } catch (const InvalidInput& error) {
    throw IoError(file.string(), fmt::format("is damaged or not complete ({})", error.what()));
  }
}

}  // namespace kappaflow
