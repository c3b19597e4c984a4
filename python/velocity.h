// Velocity methods between Python and the libraries.
#pragma once

#include <nanobind/nanobind.h>

#include <span>
#include <vector>

#include "core/connectivity.h"
#include "surface/motion/velocity.h"
#include "surface/tracker/surface_methods.h"

namespace kappaflow::python {

/// SurfacePoints with memory of its own, which Python may keep.
struct PointsHandle {
  std::vector<Vec3> position;
  std::vector<double> area;
  VertexRings rings;

  SurfacePoints points() const { return {position, area, rings}; }
};

/// method: the name of one of the library's own, or a function of Python's,
///   velocity (n, 3), confidence (n) = method(FieldHandle, PointsHandle, VelocityOptions).
/// The function is not held: whoever has a tracker keeps the functions that it calls, so that Python's
/// collector sees a function that keeps the tracker in its turn. It is called with the interpreter's lock, by
/// the thread that moves the surface; what it raises is raised by whatever moved the surface. Throws
/// InvalidInput for an unknown name.
VelocityFunction velocity_function(const nanobind::object& method);
/// The same of all ways in which a surface follows the liquid, tracked or not.
SurfaceMethod surface_method(const nanobind::object& method);

}  // namespace kappaflow::python
