// The theory of liquid rope coiling: Ribe, "Coiling of viscous jets" (2004), a slender thread that stretches,
// bends and twists.
#pragma once

namespace kappaflow {

/// A thread that leaves a round mouth straight down and falls on a plate without slip.
struct FallingThread {
  double viscosity = 0;  ///< kinematic [m2/s]
  double gravity = 0;    ///< [m/s2]
  double speed = 0;      ///< at the mouth [m/s]
  double radius = 0;     ///< there [m]
  double height = 0;     ///< of the mouth above the thread's axis on the plate [m]
};

/// Its steady coiling.
struct SteadyCoil {
  double frequency = 0;      ///< angular [rad/s]
  double radius = 0;         ///< of the coil [m]
  double thread_radius = 0;  ///< in the coil [m]
};

/// Solves for the thread's shape in the frame that turns with it: 17 ordinary differential equations for its
/// axis x, the frame q of its sections, speed U, curvatures and twist k, force N and moment M over the arc
/// length s, with the frequency W and the thread's length as unknowns. With section A = Q / U, I = A^2 / (4
/// pi) and the sections' angular velocity w = W e_z + U k,
///   N . t = 3 nu A U',  M . d = 3 nu I w' . d across and M . t = 2 nu I w' . t along,
///   N' = A (acceleration + g e_z),  M' = N x t.
/// The mouth lets nothing turn; at the plate the axis is level and the liquid at rest (w = 0). By Newton's
/// method on the midpoint rule, from a thread without gravity and inertia, which then grow to what they are.
/// Throws InvalidInput where that finds no solution: where threads coil with several frequencies.
SteadyCoil steady_coil(const FallingThread& thread);

}  // namespace kappaflow
