// The length of a time step.
#pragma once

namespace kappaflow {

/// The longest step in which a particle of `speed` [m/s] that `acceleration` [m/s2] drives moves no further
/// than `distance` [m]: speed dt + acceleration dt^2 = distance (the step moves with the velocity at its
/// end). [s]
double cfl_time_step(double speed, double acceleration, double distance);

/// `longest`, shortened such that equal steps end exactly at time_left. Equal, for what is left of a
/// compression takes a pressure of its size over dt^2 to undo: a step half as long as those before would see
/// four times as much. [s]
double fit_time_step(double longest, double time_left);

}  // namespace kappaflow
