// What a scene says of solids: its tables [[wall]] and [[body]], and the shapes and motions of these and
// others.
#pragma once

#include "scenes/scene.h"
#include "scenes/toml_reader.h"

namespace kappaflow {

// Bounds that no sensible scene meets; they keep what is computed from the numbers finite in single
// precision.
inline constexpr double kMaxLength = 1e6;  // [m]
inline constexpr double kMaxSpeed = 1e4;   // [m/s], and of rotation [rad/s]
inline constexpr double kMaxTime = 1e6;    // [s]

NumberRange length_range();

/// Each reads the keys of a shape, the last ones of its table, and finishes that. Throws InvalidInput.
BoxShape read_box(TomlTable& t);
SphereShape read_sphere(TomlTable& t);
CylinderShape read_cylinder(TomlTable& t);
MeshShape read_mesh(TomlTable& t);

/// [[wall.motion]] or [[fluid.emitter.motion]]: one for a constant velocity, several for one that is linear
/// in time between them. Throws InvalidInput.
BodyMotion read_motion(TomlTable& body);

/// [[wall]]; its heat goes to fluid.heat. Throws InvalidInput.
Wall read_wall(TomlTable t, FluidOptions& fluid);

/// [[body]]. Throws InvalidInput.
SceneBody read_body(TomlTable t, const FluidOptions& fluid);

}  // namespace kappaflow
