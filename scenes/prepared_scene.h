// A scene made ready: its files read, its walls built and its blocks filled, once for all who need them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/solid_wall.h"
#include "scenes/scene.h"
#include "solver/rigid_body.h"

namespace kappaflow {

/// The particles of all blocks, in the order of the blocks and x-fastest within one. Boxes are filled from
/// their lower corner, spheres symmetrically about their centre, meshes from the lower corner of their
/// bounding box, with one particle per spacing^3; a box's particles lie half a spacing or more inside its
/// faces, those of spheres and meshes anywhere inside. Left out are lattice points less than half a
/// spacing from a wall or body or inside it, and those within 0.9 spacings of an earlier block's particle.
struct FluidParticlesAtStart {
  std::vector<Vec3> position;  ///< [m]
  std::vector<Vec3> velocity;  ///< [m/s]
  std::vector<std::uint8_t> fluid;
  std::vector<double> temperature;  ///< [K]; empty in a scene without heat
  std::vector<int> source;          ///< the block's number; those of the emitters follow
};

/// What a scene and the mesh files that it names make. Nothing of it is read or built again by what takes it.
struct PreparedScene {
  Scene scene;
  std::vector<SolidWall> walls;   ///< one for each of scene.walls
  std::vector<RigidBody> bodies;  ///< one for each of scene.bodies
  FluidParticlesAtStart start;
  double block_area = 0;  ///< of the surfaces of all blocks, once filled [m2]
  std::string hash;       ///< TextHash of the scene's text and of the mesh files, those of the blocks first,
                          ///< then the walls' and the bodies'
};

/// Reads each mesh file once. Throws InvalidInput at the scene's line for a mesh that cannot be read or is
/// not the closed and consistently oriented boundary of a solid, a block without particles, too many
/// particles (those of the emitters included), ones too far out for single precision, an emitter whose nozzle
/// is not free, or a body in a wall or another body.
PreparedScene prepare(Scene scene);

/// The same without the particles, and what depends on them unchecked: for who has the liquid elsewhere.
PreparedScene prepare_without_particles(Scene scene);

/// Fills the blocks of such a scene, whose meshes it reads again; throws as prepare() does.
void add_particles(PreparedScene& prepared);

/// How many particles an emitter makes until the scene's end, if no liquid comes into its nozzle.
double emitted_particles(const Emitter& emitter, const Scene& scene);

}  // namespace kappaflow
