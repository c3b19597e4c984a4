// The triangle and polygon meshes in the text of .stl, .obj and .ply files.
#pragma once

#include <string_view>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// Polygons as a file has them: points may repeat, indices are within range.
struct PolygonMesh {
  std::vector<Vec3> points;
  std::vector<std::vector<int>> polygons;  ///< three or more indices of points each
};

// Each takes a file's bytes, trusts nothing in them, and throws InvalidInput that says what is wrong (and in
// which line, for text). Written here because VTK 9.1's readers end the program on some damaged files.

/// STL, binary or ASCII. Normals and attributes are ignored.
PolygonMesh parse_stl(std::string_view bytes);
/// Wavefront OBJ: `v` and `f` lines; all others are ignored.
PolygonMesh parse_obj(std::string_view text);
/// PLY 1.0, ASCII or binary of either byte order: x, y, z of `vertex`, vertex_indices (or vertex_index) of
/// `face`.
PolygonMesh parse_ply(std::string_view bytes);

}  // namespace kappaflow
