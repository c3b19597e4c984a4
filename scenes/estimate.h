// What a run of a scene will need.
#pragma once

#include <cstddef>

#include "scenes/prepared_scene.h"

namespace kappaflow {

/// What a run of the scene is expected to need.
struct SceneEstimate {
  std::size_t particles = 0;           ///< of the liquid at the start, those in nozzles left out
  std::size_t emitted = 0;             ///< by emitters until the end
  std::size_t boundary_particles = 0;  ///< of the walls
  std::size_t memory_bytes = 0;        ///< of the program at its peak, its libraries included; of one process
  double steps = 0;                    ///< of the solver
  double particle_steps = 0;           ///< sum over these of the particles
  double vertices = 0;                 ///< of one surface, when it has the most
  double seconds = 0;                  ///< wall time
  double liquid_seconds = 0;           ///< of it, without surfaces and files
  double tracker_seconds = 0;          ///< of it, of the steps of tracked surfaces
};

/// Where the liquid of several ranks is (docs/scaling.md).
struct LiquidPlace {
  double share = 1;  ///< of it on the first rank's machine
  int surface_ranks =
      0;  ///< how many ranks follow the surfaces and have none of it; 0: the first, beside its own
  int surface_ranks_here = 0;  ///< of them, those on that machine
  bool is_near = false;        ///< and whether they are told of the particles near the surface alone
  int tellers = 1;  ///< of the first ones of either kind, through whom checkpoints go, those on that machine
};

/// threads: on which the run will be, >= 1. The models and their constants stand in estimate.cpp; seconds are
/// good to a factor of about two, but for thin threads of thick liquid: docs/performance.md.
SceneEstimate estimate(const PreparedScene& prepared, int threads);

/// How many of several ranks should follow the surfaces and have none of the liquid: with which it is
/// foreseen to be quickest, on equal machines, but no more than pay. 0: the first one does both.
int ranks_for_surfaces(const SceneEstimate& cost, int ranks);

/// SceneEstimate::memory_bytes of all that the machine of the first of several ranks has to hold.
std::size_t memory_with_ranks(const Scene& scene, const SceneEstimate& cost, const LiquidPlace& place);

}  // namespace kappaflow
