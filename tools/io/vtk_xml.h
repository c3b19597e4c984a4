// Points, surfaces and images in VTK XML files, see VtkXmlReader.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/io/lattice_box.h"
#include "tools/io/point_data.h"

namespace kappaflow {

/// The points of a VTK XML file with the arrays of its points and its field arrays; of its pieces, one after
/// the other. kind: PolyData (.vtp) or UnstructuredGrid (.vtu). Cells are skipped. Throws InvalidInput that
/// says what is wrong, as all of these do.
PointData parse_vtk_xml(std::string_view bytes, std::string_view kind);

/// What a parallel VTK XML file (.pvtp, .pvtu, .pvti) gives as the sources of its pieces, in its order. kind:
/// of the pieces. Throws as parse_vtk_xml() does, and where a piece has none or there is no piece.
std::vector<std::string> parse_vtk_pieces(std::string_view bytes, std::string_view kind);

struct VtkPolygons {
  PointData points;
  PolygonList polygons;                 ///< triangle strips as triangles, behind the polygons of their piece
  std::vector<PointArray> cell_arrays;  ///< as the file has them
};

/// The same of a PolyData file with its polygons.
VtkPolygons parse_vtk_polygons(std::string_view bytes);

struct VtkSurface {
  PointData points;
  std::vector<Triangle> triangles;
  std::vector<PointArray> cell_arrays;  ///< a tuple a triangle
};

/// The same of a PolyData file with its polygons, which must be triangles of points that there are, with
/// the arrays of these.
VtkSurface parse_vtk_surface(std::string_view bytes);

/// The points of an ImageData file (.vti), of one piece or several that fill its whole extent.
LatticeData parse_vtk_image(std::string_view bytes);

/// What a parallel image file says.
struct VtkImageList {
  struct Piece {
    LatticeBox extent;  ///< the points that it has
    std::string source;
  };
  LatticeBox whole;           ///< the points of the image, by the file's numbers
  LatticeData lattice;        ///< without values; its origin is that of point 0
  std::vector<Piece> pieces;  ///< in the order of the file, one at least
};

/// The same of a parallel file (.pvti), which has no values of its own.
VtkImageList parse_vtk_image_list(std::string_view bytes);

}  // namespace kappaflow
