// Filling the blocks of a scene with particles.
#pragma once

#include <span>

#include "scenes/mesh_file.h"
#include "scenes/prepared_scene.h"

namespace kappaflow {

struct FilledBlocks {
  FluidParticlesAtStart particles;
  double area = 0;  ///< of the blocks' surfaces [m2]
};

/// The particles of the scene's blocks outside the solids: its walls and bodies. Throws InvalidInput at the
/// scene's line for a block without particles, too many particles, ones too far out for single precision, or
/// a mesh that is no solid.
FilledBlocks fill_blocks(const Scene& scene, std::span<const SolidWall> solids, MeshFiles& meshes);

/// Throws InvalidInput at the scene's line for a nozzle that reaches into a solid or, where it begins with
/// the scene, the liquid of the blocks at `filled`, or too far out; and for emitters that make too many
/// particles by the scene's end.
void check_emitters(const Scene& scene, std::span<const SolidWall> solids, std::span<const Vec3> filled);

}  // namespace kappaflow
