// A small scene with everything that the state of a run can hold.
#pragma once

namespace kappaflow {

/// Two emitters, one of them late, that moves with a profile and a ramp; three liquids, two of which yield or
/// thin and stiffen as they cool, heat, gravity in time, an outflow, a turning hot wall, a body, tension,
/// lone drops, and steps of the surfaces of several of the liquid's.
inline constexpr const char* kEverythingScene = R"(
duration = 0.12
[fluid]
spacing = 0.05
material = "paste"
surface_tension = 0.05
gravity = [[0, 0, -9.81, 0], [0.1, 3, -7, 0]]
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
temperature = 350
[[fluid.emitter]]
shape = "disc"
position = [0.4, 0.3, 0]
direction = [-1, 0, 0]
radius = 0.1
speed = [[0.02, 2.0], [0.06, 3.5]]
profile = "parabolic"
start = 0.02
particle_limit = 30
material = "melt"
temperature = 420
[[fluid.emitter.motion]]
velocity = [0, 0.3, 0]
[[wall]]
shape = "box"
lower = [-0.6, -0.2, -0.6]
upper = [0.6, 0.0, 0.6]
temperature = 500
axis = [0, 1, 0]
[[wall.motion]]
angular_velocity = 3
[[body]]
shape = "sphere"
center = [0.1, 0.45, 0.15]
radius = 0.06
density = 3000
velocity = [0, -2, 0]
angular_velocity = [0, 0, 20]
temperature = 450
[heat]
temperature = 300
specific_heat = 1000
conductivity = 1000
ambient_temperature = 290
convection = 1000
emissivity = 0.9
[[material]]
name = "paste"
model = "bingham"
yield_stress = 100
plastic_viscosity = 400
regularisation = 10
temperature_law = "arrhenius"
activation_energy = 2e4
reference_temperature = 300
[[material]]
name = "melt"
model = "carreau"
zero_shear_viscosity = 2000
time_constant = 0.5
index = 0.5
temperature_law = "vogel-fulcher-tammann"
vogel_constant = 400
vogel_temperature = 200
reference_temperature = 400
conductivity = 10
[[outflow]]
shape = "box"
lower = [-0.3, 0.0, -0.3]
upper = [-0.12, 0.12, 0.3]
[surface]
methods = ["curvature", "regional", "fresh-nearest", "fresh-particles", "fresh-grid"]
anchor = "particles"
weights = "normalised"
motion_per_step = 0.5
[output]
frames_per_second = 40
)";

}  // namespace kappaflow
