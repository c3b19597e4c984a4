// Carries one explicit mesh along with a moving implicit surface.
#pragma once

#include <string>
#include <vector>

#include "surface/field/field.h"
#include "surface/mesh/triangle_mesh.h"
#include "surface/motion/velocity.h"
#include "surface/tracker/fairing.h"
#include "surface/tracker/projection.h"
#include "surface/tracker/runge_kutta.h"

namespace kappaflow {

struct TrackerOptions {
  std::string method = "curvature";  ///< name of the velocity method, see velocity_methods()
  TimeIntegrator integrator = TimeIntegrator::rk2;
  VelocityOptions velocity{};
  ProjectionOptions projection{};
  FairingOptions fairing{};
};

/// What one step did, for metrics and timings.
struct TrackerStep {
  std::size_t unprojected = 0;  ///< vertices that are not on the surface after the step
  double residual_max =
      0;  ///< largest |f|/|g| over the projected vertices, in units of Field::length_scale()
  double velocity_seconds = 0;  ///< wall time of the advection
  double fairing_seconds = 0;   ///< wall time of fairing and projection
};

/// Tracks a surface: the mesh keeps its connectivity, its vertices move with the chosen velocity. After a
/// step every vertex is within ProjectionOptions::tolerance of f = 0 or flagged in TriangleMesh::unprojected.
class SurfaceTracker {
 public:
  /// initial_mesh: on the surface f = 0 at the start of the first step. Throws InvalidInput for an unknown
  /// method.
  SurfaceTracker(TriangleMesh initial_mesh, const TrackerOptions& options);

  /// Moves the mesh from motion.t0() to motion.t1().
  TrackerStep step(FieldMotion& motion);

  const TriangleMesh& mesh() const { return mesh_; }
  const VertexRings& rings() const { return rings_; }
  const VelocityMethod& method() const { return method_; }
  const TrackerOptions& options() const { return options_; }

 private:
  void advect(FieldMotion& motion);

  TrackerOptions options_;
  const VelocityMethod& method_;
  TriangleMesh mesh_;
  VertexRings rings_;
  FairingState fairing_;
  RungeKutta runge_kutta_;
  SurfaceVelocities velocities_;  // of the last stage of the step
  std::vector<double> area_;      // at the start of the step
};

}  // namespace kappaflow
