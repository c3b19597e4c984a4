// The body of Enright's test, exactly: what tracked surfaces are compared with.
#pragma once

#include <memory>

#include "core/particles.h"
#include "core/solid_distance.h"
#include "surface/field/particle_motion.h"
#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {

/// Of the exact shape's reference mesh, see EnrightShape [m].
inline constexpr double kEnrightResolution = 0.004, kQuickEnrightResolution = 0.01;

/// Distances between a mesh and the exact shape [m].
struct ShapeError {
  double vertex_mean = 0, vertex_max = 0;      ///< from the mesh's vertices to the shape
  double triangle_mean = 0, triangle_max = 0;  ///< from points spread over its triangles to the shape
  double shape_mean = 0, shape_max = 0;        ///< from points on the shape to the mesh: parts that it lacks
};

/// The exact shape at one time.
class EnrightShape {
 public:
  /// resolution: edge of the reference mesh on the sphere at time 0 [m]; it is carried along the flow.
  EnrightShape(double time, double resolution);

  ShapeError error(const TriangleMesh& mesh) const;

 private:
  double distance(const Vec3& x) const;

  double time_;
  TriangleMesh reference_;
  std::unique_ptr<SolidDistance> solid_;
};

/// Distance of each vertex to where its material is [m]: mean and largest.
struct VertexError {
  double mean = 0, max = 0;
};
VertexError vertex_error(const TriangleMesh& mesh, double time);

/// Particles that fill the sphere at time 0 and are carried by the flow. They lie on concentric shells a
/// spacing apart, the outermost half a spacing inside, as a Fibonacci lattice each: Eq. 12's surface is then
/// round, where that of a cubic lattice is as uneven as its cut.
class EnrightParticles {
 public:
  /// spacing [m] at time 0.
  explicit EnrightParticles(double spacing);

  /// The threshold of the field that puts the surface on the sphere, in the mean, at time 0, where the
  /// particles must be. That of the options is not used.
  double threshold(ParticleFieldOptions options) const;

  /// The particles at `time` [s], with the flow's velocities. Carries them on from the time asked for before.
  const Particles& at(double time);

 private:
  Particles particles_;
};

}  // namespace kappaflow
