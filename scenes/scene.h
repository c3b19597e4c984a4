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
#include "core/shapes.h"
#include "core/types.h"
#include "scenes/view.h"
#include "solver/options.h"
#include "surface/measure/texture.h"
#include "surface/tracker/tracked_surfaces.h"

namespace kappaflow {

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
  Vec3 velocity{0, 0, 0};             ///< [m/s]
  SourcePosition where;               ///< where the scene's file describes it
  std::uint8_t fluid = 0;             ///< which fluid, see FluidOptions
  std::optional<double> temperature;  ///< [K]; else that of HeatOptions
};
/// A rigid wall.
struct Wall {
  std::variant<BoxShape, SphereShape, CylinderShape, BasinShape, StairsShape, MeshShape> shape;  ///< at t = 0
  BodyMotion motion;
  SourcePosition where;  ///< where the scene's file describes it
};

/// A rigid body that liquid moves.
struct SceneBody {
  std::variant<BoxShape, SphereShape, CylinderShape, MeshShape> shape;  ///< at t = 0
  std::optional<double> density, mass;                                  ///< one of them [kg/m3], [kg]
  Vec3 velocity{0, 0, 0};                                               ///< of its centre of mass [m/s]
  Vec3 angular_velocity{0, 0, 0};                                       ///< [rad/s]
  double friction = 0.5;                                                ///< see RigidBody
  WallHeat heat;
  SourcePosition where;  ///< where the scene's file describes it
};

/// How the surface is defined, meshed and tracked: SurfaceOptions as far as they do not follow from the
/// liquid, and the methods by their names.
struct SurfaceDescription : SurfaceOptions {
  /// From surface_methods(); may be empty.
  std::vector<std::string> methods{"material"};
};

inline constexpr double kFinestEdge = 0.05, kCoarsestEdge = 2;  ///< SurfaceOptions::edge_length

struct OutputDescription {
  double frames_per_second = 25;
  Vec3 report_axis{0, 0, 1};  ///< axis of rotation_captured, normalised
  double checker_size = 2.5;  ///< edge of a checker cube in units of sigma
  TextureProjection texture = TextureProjection::box;
  int checkpoint_interval = 1;  ///< frames from one checkpoint to the next
  /// Frames from one whose surfaces are judged (SurfaceJudgement, and material tracers) to the next, the
  /// last one apart; 0: none.
  int metrics_interval = 1;
  int rest_interval = 0;  ///< see RestPair; 0: no such arrays
  View view;              ///< of pictures
};

struct Scene {
  std::filesystem::path file;
  std::string text;  ///< of the file, verbatim
  std::string title;
  double duration = 0;  ///< [s]
  FluidOptions fluid;
  std::vector<std::string> materials;  ///< by fluid: the name of its material; empty where it has a viscosity
  std::vector<FluidBlock> blocks;
  std::vector<SourcePosition> emitters_where;  ///< where the scene's file describes fluid.emitters
  std::vector<Wall> walls;
  std::vector<SceneBody> bodies;
  SurfaceDescription surface;
  OutputDescription output;
};

/// Reads a scene and checks what its text says; what its meshes and particles are, prepare() checks. Throws
/// InvalidInput "file:line:column: found; allowed" for the first mistake.
Scene load_scene(const std::filesystem::path& file);
/// The same of a text that was read from `file`: errors name it, and meshes lie beside it.
Scene parse_scene(const std::string& text, const std::filesystem::path& file);

}  // namespace kappaflow
