// A surface that is meshed anew in every frame: what one uses who does not track.
#pragma once

#include <optional>

#include "surface/measure/surface_state.h"
#include "surface/mesh/triangle_mesh.h"
#include "surface/tracker/rest_grid.h"
#include "surface/tracker/tracker_options.h"

namespace kappaflow {

/// In each frame the isosurface f = 0 by marching cubes (Lorensen & Cline 1987; see extract_isosurface()),
/// with its vertices on the surface. A vertex has nothing to do with those of the frame before: it gets a new
/// id, and its entry in every array, by the array's rule, from the nearest point of the last frame's mesh;
/// where there is a grid, its rest position from that.
class FreshSurface {
 public:
  /// first: the mesh of the first frame, whose arrays all later ones have. spacing: of the lattice [m].
  /// velocity, options: what state() shows of the motion, which moves nothing here.
  FreshSurface(TriangleMesh first, double spacing, VelocityFunction velocity, const VelocityOptions& options,
               std::optional<RestGrid> grid = std::nullopt);

  /// Carries the grid along, where there is one: the mesh of a frame needs no step before.
  TrackerStep step(FieldMotion& motion);

  /// Meshes the surface of a frame.
  TrackerStep settle(const Field& field);

  /// At rest against the material, as far as anybody can tell: no slip, and no rotation that is captured.
  SurfaceState state(const Field& field) const;

  const TriangleMesh& mesh() const { return mesh_; }
  TriangleMesh& mesh() { return mesh_; }

  /// See core/saved_state.h; for a surface that was made with the same options.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(mesh_);
    if (grid_) archive(*grid_);
  }

 private:
  void take_over(TriangleMesh fresh);

  TriangleMesh mesh_;
  double spacing_;
  VelocityFunction velocity_;
  VelocityOptions velocity_options_;
  std::optional<RestGrid> grid_;
};

}  // namespace kappaflow
