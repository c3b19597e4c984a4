// A scene: everything that a run needs, as read from a TOML file.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/body_motion.h"
#include "core/errors.h"
#include "core/types.h"
#include "scenes/view.h"
#include "solver/options.h"
#include "surface/measure/texture.h"
#include "surface/tracker/tracked_surfaces.h"

namespace kappaflow {

struct BoxShape {
  Vec3 lower, upper;  ///< corners [m]
};
struct SphereShape {
  Vec3 center;        ///< [m]
  double radius = 0;  ///< [m]
};
/// A round bar.
struct CylinderShape {
  Vec3 from, to;      ///< centres of its ends [m]
  double radius = 0;  ///< [m]
};
/// A box without a lid, open along +y, around the space from `lower` to `upper`.
struct BasinShape {
  Vec3 lower, upper;     ///< corners of the space inside [m]
  double thickness = 0;  ///< of floor and sides, outwards [m]
};
/// A flight of stairs that goes down along +x, y up, extruded along z, as one closed solid. With (x0, y0, z0)
/// = origin: the landing is at y = y0 + steps rise and ends at the first riser, x = x0 - (steps - 1) run;
/// after riser i comes a tread at y = y0 + (steps - i) rise that is `run` long; the last riser stands at x0,
/// and the floor, y = y0, follows it.
struct StairsShape {
  int steps = 5;             ///< number of risers
  double rise = 0, run = 0;  ///< height and depth of a step [m]
  double landing = 0;        ///< length of the landing before the first riser [m]
  double floor = 0;          ///< length of the floor after the last riser [m]
  double width = 0;          ///< extent along z, centred on z0 [m]
  double thickness = 0;      ///< of the solid under the floor [m]
  Vec3 origin{0, 0, 0};      ///< foot of the last riser, at mid-width [m]
};
/// A closed triangle mesh from a file; a point p of the file is at scale p + translation.
struct MeshShape {
  std::filesystem::path file;  ///< .stl, .obj or .ply; in a scene file relative to that file's folder
  double scale = 1;            ///< metres per unit of the file
  Vec3 translation{0, 0, 0};   ///< [m]
};

/// A block of liquid, filled with particles on a cubic lattice.
struct FluidBlock {
  std::variant<BoxShape, SphereShape, MeshShape> shape;
  Vec3 velocity{0, 0, 0};  ///< [m/s]
  SourcePosition where;    ///< where the scene's file describes it
  std::uint8_t fluid = 0;  ///< index of its viscosity, see FluidOptions
};
/// A rigid wall.
struct Wall {
  std::variant<BoxShape, SphereShape, CylinderShape, BasinShape, StairsShape, MeshShape> shape;  ///< at t = 0
  BodyMotion motion;
  SourcePosition where;  ///< where the scene's file describes it
};

/// How the surface is defined, meshed and tracked: SurfaceOptions as far as they do not follow from the
/// liquid, and the velocity methods by their names.
struct SurfaceDescription : SurfaceOptions {
  /// To track with, from velocity_methods(); may be empty.
  std::vector<std::string> methods{"material"};
  int stride = 1;  ///< solver steps per tracker step; a frame always ends one
};

struct OutputDescription {
  double frames_per_second = 25;
  Vec3 report_axis{0, 0, 1};  ///< axis of rotation_captured, normalised
  double checker_size = 4;    ///< edge of a checker cube in units of sigma
  TextureProjection texture = TextureProjection::box;
  int checkpoint_interval = 1;  ///< frames from one checkpoint to the next
  View view;                    ///< of pictures
};

struct Scene {
  std::filesystem::path file;
  std::string text;  ///< of the file, verbatim
  std::string title;
  double duration = 0;  ///< [s]
  FluidOptions fluid;
  std::vector<FluidBlock> blocks;
  std::vector<SourcePosition> emitters_where;  ///< where the scene's file describes fluid.emitters
  std::vector<Wall> walls;
  SurfaceDescription surface;
  OutputDescription output;
};

/// Reads and checks a scene, with the meshes that it names and the particles that it yields. Throws
/// InvalidInput "file:line:column: found; allowed" for the first mistake.
Scene load_scene(const std::filesystem::path& file);
/// The same of a text that was read from `file`: errors name it, and meshes lie beside it.
Scene parse_scene(const std::string& text, const std::filesystem::path& file);

/// The particles of all blocks, in the order of the blocks and x-fastest within one. Boxes are filled from
/// their lower corner, spheres symmetrically about their centre, meshes from the lower corner of their
/// bounding box, with one particle per spacing^3; a box's particles lie half a spacing or more inside its
/// faces, those of spheres and meshes anywhere inside. Left out are lattice points less than half a
/// spacing from a wall or inside it, and those within 0.9 spacings of an earlier block's particle.
struct FluidParticlesAtStart {
  std::vector<Vec3> position;  ///< [m]
  std::vector<Vec3> velocity;  ///< [m/s]
  std::vector<std::uint8_t> fluid;
  std::vector<int> source;  ///< the block's number; those of the emitters follow
};
/// Throws InvalidInput for a block without particles, too many particles (those of the emitters included),
/// ones too far out for single precision, a mesh that is no solid, or an emitter whose nozzle is not free.
FluidParticlesAtStart fill_blocks(const Scene& scene);

/// How many particles an emitter makes until the scene's end, if no liquid comes into its nozzle.
double emitted_particles(const Emitter& emitter, const Scene& scene);

/// The walls as closed surfaces, oriented outward. Throws InvalidInput for a mesh that cannot be read, is
/// empty, or is not the closed and consistently oriented boundary of a solid.
std::vector<TriangleSurface> wall_surfaces(const Scene& scene);

/// How they move, one motion a wall; empty when all are at rest.
std::vector<BodyMotion> wall_motions(const Scene& scene);

/// The walls of wall_surfaces() and wall_motions() where they are at `time` [s].
std::vector<TriangleSurface> walls_at(double time, std::vector<TriangleSurface> walls,
                                      std::span<const BodyMotion> motions);

/// What a run of the scene is expected to need.
struct SceneEstimate {
  std::size_t particles = 0;           ///< of the liquid at the start, those in nozzles left out
  std::size_t emitted = 0;             ///< by emitters until the end
  std::size_t boundary_particles = 0;  ///< of the walls
  std::size_t memory_bytes = 0;        ///< of the program at its peak, its libraries included
  double steps = 0;                    ///< of the solver
  double particle_steps = 0;           ///< sum over these of the particles
  double vertices = 0;                 ///< of one surface, when it has the most
  double seconds = 0;                  ///< wall time
};
/// threads: on which the run will be, >= 1. The models and their constants stand in estimate.cpp; seconds are
/// good to a factor of about two.
SceneEstimate estimate(const Scene& scene, int threads);

}  // namespace kappaflow
