// The theory of a viscous strip that folds on a plate: slender, it stretches and bends in one plane.
#pragma once

namespace kappaflow {

/// A strip that leaves a slot straight down and falls on a plate without slip. Its sides are free.
struct FallingStrip {
  double viscosity = 0;  ///< kinematic [m2/s]
  double gravity = 0;    ///< [m/s2]
  double speed = 0;      ///< at the slot [m/s]
  double thickness = 0;  ///< there [m]
  double width = 0;      ///< there, of the sides that do not bend [m]
  double height = 0;     ///< of the slot above the strip's axis on the plate [m]
};

/// The angular frequency [rad/s] with which it folds, there and back. The strip is a chain of nodes that the
/// liquid carries, each segment of constant volume. With section A, I = A thickness^2 / 12 and the segments'
/// lengths l and angles phi, stretching takes the force 3 nu A (dl/dt) / l and bending between two segments
/// the moment 3 nu I (dphi/dt) / l (Trouton, 1906); mass and weight are at the nodes, which stay where they
/// touch the plate. Velocities are implicit in time. As in Ribe, "Periodic folding of viscous sheets" (2003),
/// one layer of folds does not lie on another. Throws InvalidInput where it does not fold.
double folding_frequency(const FallingStrip& strip);

}  // namespace kappaflow
