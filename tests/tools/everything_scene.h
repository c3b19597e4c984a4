// A small scene with everything that the state of a run can hold.
#pragma once

namespace kappaflow {

/// Two emitters and viscosities, a turning wall, tension, lone drops, and
/// steps of the surfaces of several of the liquid's.
inline constexpr const char* kEverythingScene = R"(
duration = 0.12
[fluid]
spacing = 0.05
kinematic_viscosity = 0.5
surface_tension = 0.05
[[fluid.block]]
shape = "box"
lower = [-0.2, 0.05, -0.2]
upper = [0.2, 0.35, 0.2]
velocity = [0, -0.5, 0]
[[fluid.emitter]]
shape = "disc"
position = [0, 0.5, 0]
direction = [0, -1, 0]
radius = 0.1
speed = 2.0
kinematic_viscosity = 2.0
[[fluid.emitter]]
shape = "disc"
position = [0.4, 0.3, 0]
direction = [-1, 0, 0]
radius = 0.1
speed = 3.0
start = 0.02
particle_limit = 30
[[wall]]
shape = "box"
lower = [-0.6, -0.2, -0.6]
upper = [0.6, 0.0, 0.6]
axis = [0, 1, 0]
[[wall.motion]]
angular_velocity = 3
[surface]
methods = ["curvature", "regional", "fresh-nearest", "fresh-particles", "fresh-grid"]
anchor = "particles"
weights = "normalised"
motion_per_step = 0.5
[output]
frames_per_second = 40
)";

}  // namespace kappaflow
