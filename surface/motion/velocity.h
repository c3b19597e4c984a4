// What a velocity method is: how fast each point of an implicit surface moves. One function over a batch of
// points; the library's own are in this folder, a program's own may be any other (docs/extending.md).
//
// Every method has the same normal part, Eq. 4: v_n = -f_t g/|g|^2; they differ in the motion along the
// surface.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/connectivity.h"
#include "core/named.h"
#include "surface/field/field.h"

namespace kappaflow {

/// A batch of points on the surface at one instant. Pointwise methods read the positions alone; `regional`
/// reads all.
struct SurfacePoints {
  std::span<const Vec3> position;  ///< [m]
  std::span<const double> area;    ///< a third of the area of the triangles around the point [m2]
  const VertexRings& rings;        ///< one-ring neighbours
};

/// Before the tangential velocity the rows of Eqs. 5, 7 and 8 have units of 1/m, 1/m3 and 1/m2. sigma: the
/// field's length scale makes them dimensionless. metre: nothing does, which is the sum of squares of Eq. 10
/// as printed; its minimum depends on the unit of length.
enum class RowScale { sigma, metre };

/// What scenes call them.
inline constexpr Named<RowScale> kRowScales[] = {{"sigma", RowScale::sigma}, {"metre", RowScale::metre}};

/// Options of the velocity methods.
struct VelocityOptions {
  /// lambda of the damped least squares (R^T R + lambda^2 I) y = R^T b on the dimensionless rows. 0.1 suits
  /// flows, 1e-6 rigid bodies. `regional` scales its confidence with it and nothing else.
  double damping = 0.1;
  /// |v_t| and |v_n| are limited to this factor times the fastest speed in reach, Jet::fastest_in_reach;
  /// |v_t| of `regional` to that of its window. In a rotation the surface is faster than any particle centre:
  /// use 4 for few rotating particles.
  double speed_limit = 1;
  /// Of the methods that keep normals and curvatures; with metre the damping is in units of these rows.
  RowScale row_scale = RowScale::sigma;
};

/// Where a method writes what it finds: one entry a point.
struct VelocitySpans {
  std::span<Vec3> velocity;      ///< [m/s]; zero where the field has no gradient
  std::span<double> confidence;  ///< how well the tangential part is determined, in [0, 1]
};

/// The memory for it, which is used again.
struct SurfaceVelocities {
  std::vector<Vec3> velocity;
  std::vector<double> confidence;

  /// With room for so many points.
  VelocitySpans sized(std::size_t points) {
    velocity.resize(points);
    confidence.resize(points);
    return {velocity, confidence};
  }
};

/// Writes velocity and confidence of every point. Called once for every stage of a time step; must be a
/// function of its arguments alone, whatever the number of threads. What it throws leaves the tracker's step.
using VelocityFunction = std::function<void(const Field& field, const SurfacePoints& points,
                                            const VelocityOptions& options, VelocitySpans result)>;

}  // namespace kappaflow
