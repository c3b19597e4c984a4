// Closed meshes of a liquid's surface, as a reconstruction writes them.
#pragma once

#include <filesystem>
#include <optional>

#include "core/types.h"

namespace kappaflow {

/// A closed surface at one instant.
struct MeshFrame {
  TriangleSurface surface;       ///< [m], oriented outward
  std::optional<double> time{};  ///< [s], where the file says it
};

/// Reads .obj, .ply, .stl, .vtp (VTK XML) or .vtk (legacy VTK), polydata both, by the ending of the name.
/// Polygons and strips are cut into triangles, equal points merged, the whole turned outward where it
/// encloses a negative volume; pieces that face inward beside others are cavities. Each edge must be used as
/// often in one direction as in the other: by two triangles, or by four where bodies touch. Throws IoError
/// (not readable, not complete), InvalidInput (a point that is not finite, fewer than four triangles, an edge
/// that is open or where orientations differ, no volume).
MeshFrame read_mesh_frame(const std::filesystem::path& file);

}  // namespace kappaflow
