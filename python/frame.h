// What a surface shows at one instant, as arrays.
#pragma once

#include "python/arrays.h"
#include "surface/tracker/tracked_surfaces.h"

namespace kappaflow::python {

/// Copies of the mesh, which moves on, and what was computed on it.
struct SurfaceSnapshot {
  double time = 0;  ///< [s]
  TriangleMesh mesh;
  SurfaceState state;
};

SurfaceSnapshot snapshot(const TrackedSurfaces& surfaces, std::size_t surface);

/// Under `positions`, `triangles` and, of the arrays over the vertices, the names that surface files give
/// them (docs/outputs.md); `area` and `material_velocity` beside these. `source` and `material_slip` only
/// where they are known.
NamedArrays arrays_of(SurfaceSnapshot snapshot);

}  // namespace kappaflow::python
