// Points, polygons and images in legacy VTK files.
#pragma once

#include <string_view>

#include "tools/io/point_data.h"
#include "tools/io/vtk_xml.h"

namespace kappaflow {

/// The points of a legacy VTK file (.vtk, text or binary) that holds polydata or an unstructured grid, with
/// the arrays of its points and its field arrays. Cells and their arrays are skipped. Trusts nothing in the
/// file, and throws InvalidInput that says what is wrong. Written here because VTK 9.1's reader crashes on
/// damaged files, and asks for as much memory as they claim to need.
PointData parse_legacy_vtk(std::string_view bytes);

/// The same of polydata with its polygons; triangle strips as triangles. Cells and their arrays are skipped
/// but for these.
VtkPolygons parse_legacy_polygons(std::string_view bytes);

/// The same of structured points, with the arrays of points and of cells.
LatticeData parse_legacy_image(std::string_view bytes);

}  // namespace kappaflow
