// Points and surfaces in VTK XML files.
#pragma once

#include <string_view>
#include <vector>

#include "tools/io/point_data.h"

namespace kappaflow {

/// The points of a VTK XML file with the arrays of its points and its field arrays; of its pieces, one after
/// the other. kind: PolyData (.vtp) or UnstructuredGrid (.vtu). Arrays may be text, inline binary or appended
/// (base64 or raw), of either byte order, and compressed in the ways that VTK knows. Cells are skipped.
/// Trusts nothing in the file, and throws InvalidInput that says what is wrong. Written here because
/// VTK 9.1's readers crash on damaged files, and ask for as much memory as they claim to need.
PointData parse_vtk_xml(std::string_view bytes, std::string_view kind);

struct VtkSurface {
  PointData points;
  std::vector<Triangle> triangles;
  std::vector<PointArray> cell_arrays;  ///< a tuple a triangle
};

/// The same of a PolyData file with its polygons, which must be triangles of points that there are, with
/// the arrays of these.
VtkSurface parse_vtk_surface(std::string_view bytes);

}  // namespace kappaflow
