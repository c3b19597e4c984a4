// A scene: everything that a run needs, as read from a TOML file.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/types.h"
#include "solver/fluid_solver.h"
#include "surface/field/particle_motion.h"
#include "surface/tracker/surface_tracker.h"

namespace kappaflow {

struct BoxShape {
  Vec3 lower, upper;  ///< corners [m]
};
struct SphereShape {
  Vec3 center;        ///< [m]
  double radius = 0;  ///< [m]
};
/// A flight of stairs that goes down along +x from a landing to a floor, extruded along z, as one closed solid:
/// the landing's top is at y = floor_height + steps * rise and ends at x = start; the i-th tread is `rise` lower and
/// `run` long; after the last comes the floor.
struct StairsShape {
  int steps = 5;
  double rise = 0, run = 0;     ///< height and depth of a step [m]
  double landing = 0;           ///< length of the landing before the first edge [m]
  double floor = 0;             ///< length of the floor after the last step [m]
  double width = 0;             ///< extent along z, centred on z = 0 [m]
  double thickness = 0;         ///< of the solid under the floor [m]
  Vec3 origin{0, 0, 0};         ///< foot of the last riser, at mid-width [m]
};
struct MeshShape {
  std::filesystem::path file;   ///< .stl, .obj or .ply, closed; relative to the scene file
  double scale = 1;
  Vec3 translation{0, 0, 0};
};

/// A block of liquid, filled with particles on a cubic lattice.
struct FluidBlock {
  std::variant<BoxShape, SphereShape> shape;
  Vec3 velocity{0, 0, 0};  ///< [m/s]
};
struct Wall {
  std::variant<BoxShape, StairsShape, MeshShape> shape;
};

/// How the surface is defined, meshed and tracked; lengths relative to the particle spacing or sigma, as stated.
struct SurfaceDescription {
  double sigma = 2;                       ///< support radius of Eq. 12 in particle spacings
  WeightRule weights = WeightRule::uniform;
  std::optional<double> threshold;        ///< T of Eq. 12; empty ("auto"): half the median of the field at the particles
  double edge_length = 0.5;               ///< spacing of the first mesh's lattice in units of sigma
  std::vector<std::string> methods;       ///< velocity methods to track with, from velocity_methods()
  TrackerOptions tracker;                 ///< method is set from `methods`
  int stride = 1;                         ///< solver steps per tracker step; a frame always ends one
};

enum class TextureProjection { planar, spherical, box };

struct OutputDescription {
  double frames_per_second = 25;
  Vec3 report_axis{0, 0, 1};              ///< axis of rotation_captured, normalised
  double checker_size = 4;                ///< edge of a checker cube in units of sigma
  TextureProjection texture = TextureProjection::box;
};

struct Scene {
  std::filesystem::path file;
  std::string text;                       ///< of the file, verbatim
  std::string title;
  double duration = 0;                    ///< [s]
  FluidOptions fluid;
  std::vector<FluidBlock> blocks;
  std::vector<Wall> walls;
  SurfaceDescription surface;
  OutputDescription output;
};

/// Reads and checks a scene. Throws InvalidInput "file:line:column: found; allowed" for the first mistake: unknown key,
/// wrong type, number out of range, missing file, fluid without particles or with more than 2^31 - 1.
Scene load_scene(const std::filesystem::path& file);

/// The particles of all blocks: positions and velocities [m, m/s]. A lattice point that an earlier block filled, or
/// that lies inside a wall, is left out.
struct FluidParticlesAtStart {
  std::vector<Vec3> position, velocity;
};
FluidParticlesAtStart fill_blocks(const Scene& scene);

/// The walls as closed surfaces, oriented outward. Throws InvalidInput for a mesh that cannot be read or is not closed.
std::vector<TriangleSurface> wall_surfaces(const Scene& scene);

/// What `kappaflow check` prints.
struct SceneEstimate {
  std::size_t particles = 0;
  std::size_t boundary_particles = 0;
  std::size_t memory_bytes = 0;
  double seconds = 0;        ///< expected wall time on this machine's threads
};
SceneEstimate estimate(const Scene& scene, int threads);

}  // namespace kappaflow
