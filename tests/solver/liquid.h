// The state inside the solver, for tests of its parts.
#pragma once

#include "solver/boundary.h"
#include "solver/neighbours.h"
#include "solver/start.h"

namespace kappaflow::test {

/// Particles, neighbours and walls as FluidSolver prepares them for a step. Particles are in cell order.
struct Liquid {
  Liquid(const std::vector<Vec3>& position, const std::vector<Vec3>& velocity, float spacing,
         const std::vector<WallSample>& wall_samples = {}, const BodyMotion& motion = {})
      : particles(particles_at_start(position, velocity)),
        search(spacing),
        walls(std::vector{WallBody{wall_samples, motion}}, spacing) {
    update();
  }

  void update() {
    search.sort(particles);
    search.find(particles, lists);
    walls.add_to(particles, wall_sums);
  }

  FluidParticles particles;
  NeighbourSearch search;
  NeighbourLists lists;
  Walls walls;
  WallSums wall_sums;
};

}  // namespace kappaflow::test
