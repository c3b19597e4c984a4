// Everything that is reported about a tracked surface at one instant.
#pragma once

#include <optional>
#include <vector>

#include "surface/field/field.h"
#include "surface/mesh/triangle_mesh.h"
#include "surface/motion/velocity.h"

namespace kappaflow {

/// Arrays over the vertices at one instant.
struct SurfaceState {
  std::vector<Vec3> normal;                ///< outward unit normal of the field; zero where g vanishes
  std::vector<double> area;                ///< vertex_areas() [m2]
  std::vector<double> gaussian_curvature;  ///< K [1/m2]
  std::vector<double> mean_curvature;      ///< H [1/m], > 0 on a sphere
  SurfaceVelocities motion;                ///< velocity and confidence of the method
  std::vector<Vec3> material_velocity;     ///< velocity of the material [m/s]; empty where unknown
  std::vector<double> material_slip;       ///< its tangential distance to the method's [m/s]; empty likewise
};

SurfaceState surface_state(const Field& field, const TriangleMesh& mesh, const VertexRings& rings,
                           const VelocityFunction& method, const VelocityOptions& options);

/// Root mean square (area-weighted) of material_slip over that of the tangential material velocity.
/// nullopt where the material velocity is unknown or zero.
std::optional<double> slip(const SurfaceState& state);

/// How much of the material's rotation one connected piece of the surface takes part in.
struct PieceRotation {
  std::size_t vertices = 0;
  /// Angular velocity about the axis of the least-squares rigid motion of the piece's vertices under the
  /// method's velocity, over the same fitted to the material velocity. nullopt where that is unknown or
  /// (nearly) zero.
  std::optional<double> captured;
};

/// One entry a connected piece, in the order of their first vertices; axis: a unit vector.
std::vector<PieceRotation> rotation_by_piece(const TriangleMesh& mesh, const SurfaceState& state,
                                             const Vec3& axis);

/// PieceRotation::captured of the piece with the most vertices (of the first such piece); nullopt without
/// pieces.
std::optional<double> largest_piece_rotation(std::span<const PieceRotation> pieces);

/// Angular velocity vector [1/s] of the area-weighted least-squares rigid motion of the selected vertices.
Vec3 fitted_angular_velocity(std::span<const Vec3> position, std::span<const double> area,
                             std::span<const Vec3> velocity);

}  // namespace kappaflow
