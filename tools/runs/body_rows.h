// bodies.csv: where rigid bodies are and how they move, a row a frame and body.
#pragma once

#include <span>
#include <string>

#include "solver/rigid_body.h"

namespace kappaflow {

/// With the line's end: frame, time [s], body, x, y, z of the centre of mass [m], the rotation since t = 0 as
/// a unit quaternion qx, qy, qz, qw >= 0, the centre's velocity vx, vy, vz [m/s], and the angular velocity
/// wx, wy, wz [rad/s], all in the scene's axes.
std::string bodies_header();
std::string bodies_rows(int frame, double time, std::span<const BodyState> bodies);

}  // namespace kappaflow
