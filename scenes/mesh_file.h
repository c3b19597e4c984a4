// Reading a solid from a mesh file.
#pragma once

#include <filesystem>

#include "core/errors.h"
#include "core/types.h"

namespace kappaflow {

struct MeshShape;

/// The triangles of an .stl, .obj or .ply file in the file's own units, polygons cut into triangles, equal
/// points merged; closed, and oriented outward whichever way the file has it; of pieces that may overlap: see
/// solids_of(). Throws InvalidInput at `where` (the scene that names the file) when it cannot be read, has no
/// triangles or degenerate ones, is not the consistently oriented boundary of a solid, or has pieces of which
/// check_crossings() or solids_of() cannot tell inside from outside.
TriangleSurface read_closed_mesh(const std::filesystem::path& file, const SourcePosition& where);

/// The same of a scene's mesh, scaled and moved to its place [m].
TriangleSurface mesh_surface(const MeshShape& mesh, const SourcePosition& where);

}  // namespace kappaflow
