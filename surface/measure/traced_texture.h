// What a surface's texture says of the material, whichever way it was carried along: rest positions where
// material tracers are.
#pragma once

#include <optional>
#include <vector>

#include "surface/measure/material_tracers.h"
#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {

/// The rest position of the mesh at its point nearest to each tracer.
struct TracedTexture {
  std::vector<Vec3> rest;   ///< [m]
  std::vector<char> known;  ///< 1 where the tracer is not lost and at the surface

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(rest, known);
  }
};

/// A tracer is at the surface within this of the mesh [sigma]: one that two bodies have shut in is not.
inline constexpr double kAtSurface = 0.5;

/// sigma [m].
TracedTexture traced_texture(const TriangleMesh& mesh, const MaterialTracers& tracers, double sigma);

/// Mean distance of these rest positions from where the tracers started, over sigma [1]. nullopt where none
/// is known. Unlike tracer_distance() it asks for no vertex that has been there from the start, so that it
/// treats all surfaces alike; it is measured in the first mesh, not where the liquid is now.
std::optional<double> texture_distance(const TracedTexture& texture, const MaterialTracers& tracers,
                                       double sigma);

/// Mean distance of these rest positions from those of the frame before, over sigma [1]: a texture that is
/// carried along by the material does not change where a tracer is. nullopt where none is known in both.
std::optional<double> texture_flicker(const TracedTexture& before, const TracedTexture& now, double sigma);

}  // namespace kappaflow
