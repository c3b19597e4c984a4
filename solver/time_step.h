// The length of a time step.
#pragma once

namespace kappaflow {

/// The longest step in which a particle of `speed` [m/s] that `acceleration` [m/s2] drives moves no further
/// than `distance` [m]: speed dt + acceleration dt^2 = distance (the step moves with the velocity at its
/// end). [s]
double cfl_time_step(double speed, double acceleration, double distance);

/// `longest`, shortened such that the steps end exactly at time_left and the last is no sliver: time_left
/// when it is at most `longest`, half of it when it is less than two steps. [s]
double fit_time_step(double longest, double time_left);

}  // namespace kappaflow
