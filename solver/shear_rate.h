// How fast liquid is sheared, from a velocity gradient that is right to first order.
#pragma once

#include <vector>

#include "solver/boundary.h"
#include "solver/fluid_particles.h"
#include "solver/neighbours.h"

namespace kappaflow {

/// sqrt(2 D : D) [1/s] at particle i, D the traceless rate of strain of the velocities v, one a particle. The
/// gradient is exact for a linear v, at a free surface too (Bonet & Lok, "Variational and momentum
/// preservation aspects of smooth particle hydrodynamics formulations", 1999):
///   G = B C^-1,   B = sum_j V (v_j - v_i) (x) grad W_ij,   C = sum_j V (x_j - x_i) (x) grad W_ij.
/// A wall counts as one more neighbour at the contact distance, half a spacing, so that the gradient is exact
/// where the particle is that far from it; with the velocity of its surface, and with `slip`, the contact
/// distance over itself and the slip length, of what v differs along it. Its weight is that with
/// which the gradient in the first layer of a lattice is exact for a quadratic profile too. Directions in
/// which there are no neighbours have no gradient.
float shear_rate(std::size_t i, const FluidParticles& particles, const NeighbourLists& lists,
                 const WallSums& walls, const std::vector<Vec4f>& v, float spacing, float slip);

}  // namespace kappaflow
