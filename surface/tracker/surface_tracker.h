// Carries one explicit mesh along with a moving implicit surface.
#pragma once

#include <string>

#include "surface/field/field.h"
#include "surface/mesh/triangle_mesh.h"
#include "surface/motion/velocity.h"
#include "surface/tracker/fairing.h"
#include "surface/tracker/projection.h"

namespace kappaflow {

/// Time integration of the vertices: explicit Runge-Kutta of order 1, 2 (midpoint) or 4 (classical).
enum class TimeIntegrator { euler, rk2, rk4 };

struct TrackerOptions {
  std::string method = "curvature";                     ///< name of the velocity method, see velocity_methods()
  TimeIntegrator integrator = TimeIntegrator::rk2;
  VelocityOptions velocity;
  ProjectionOptions projection;
  FairingOptions fairing;
};

/// What one step did, for metrics and timings.
struct TrackerStep {
  std::size_t unprojected = 0;   ///< vertices that are not on the surface after the step
  double residual_max = 0;       ///< largest |f|/|g| over the projected vertices, in units of Field::length_scale()
  double velocity_seconds = 0;   ///< wall time of the advection
  double fairing_seconds = 0;    ///< wall time of fairing and projection
};

/// Tracks a surface: the mesh keeps its connectivity, its vertices move with the chosen velocity.
class SurfaceTracker {
 public:
  /// initial_mesh: on the surface f = 0 at the start of the first step. Throws InvalidInput for an unknown method.
  SurfaceTracker(TriangleMesh initial_mesh, const TrackerOptions& options);

  /// Moves the mesh from motion.t0() to motion.t1().
  TrackerStep step(FieldMotion& motion);

  const TriangleMesh& mesh() const { return mesh_; }
  const VertexRings& rings() const { return rings_; }
  const VelocityMethod& method() const { return method_; }
  const TrackerOptions& options() const { return options_; }

 private:
  TrackerOptions options_;
  const VelocityMethod& method_;
  TriangleMesh mesh_;
  VertexRings rings_;
  FairingState fairing_;
};

}  // namespace kappaflow
