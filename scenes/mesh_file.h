// Reading solids from mesh files.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "core/errors.h"
#include "core/types.h"

namespace kappaflow {

struct MeshShape;
struct PolygonMesh;

/// Triangles of what a file has: polygons, which need not be convex, are cut, points with the same
/// coordinates merged, triangles that have two corners in one place then left out, and points that none uses.
/// Throws InvalidInput for a point that is not finite, or a polygon that cannot be cut.
TriangleSurface triangle_surface(PolygonMesh mesh);

/// A file that was read.
struct ClosedMesh {
  std::string bytes;        ///< of the file
  TriangleSurface surface;  ///< in the file's own units
};

/// The triangles of an .stl, .obj or .ply file in the file's own units, polygons cut into triangles, equal
/// points merged; closed, and oriented outward whichever way the file has it; of pieces that may overlap: see
/// solids_of(). With the bytes of the file. Throws InvalidInput at `where` (the scene that names the file)
/// when it cannot be read, has no triangles or degenerate ones, is not the consistently oriented boundary of
/// a solid, or has pieces of which check_crossings() or solids_of() cannot tell inside from outside.
ClosedMesh read_closed_mesh(const std::filesystem::path& file, const SourcePosition& where);

/// The mesh files of a scene, each read once however often the scene names it.
class MeshFiles {
 public:
  /// What the mesh names, read where it has not been; throws as read_closed_mesh() does.
  const ClosedMesh& read(const MeshShape& mesh, const SourcePosition& where);

  /// Its surface, scaled and moved to its place [m].
  TriangleSurface surface(const MeshShape& mesh, const SourcePosition& where);

 private:
  std::map<std::filesystem::path, ClosedMesh> known_;
};

}  // namespace kappaflow
