// `kappaflow benchmark`: how fast the solver is on a scene, phase by phase.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "solver/ranks.h"

namespace kappaflow {

struct BenchmarkOptions {
  std::filesystem::path scene;
  std::vector<std::size_t> particles;  ///< sizes to try; empty: the scene's own
  std::vector<int> threads;            ///< to try
  int warm_up = 5, steps = 20;         ///< solver steps that are not measured, and that are
  std::filesystem::path csv;           ///< empty: none
  Ranks* ranks = nullptr;              ///< that share the liquid, this being one of them
};

/// Runs the scene's liquid at every size with every number of threads and returns a table: time a step and by
/// phase, iterations, particle steps a second, seconds a simulated second, bytes a particle; of several ranks
/// also what they send and wait for, and below the table the balanced_shares() of each of its columns. A size
/// is reached by another particle spacing, everything else stays. Writes the same as CSV. Throws as
/// FluidSolver does.
std::string benchmark(const BenchmarkOptions& options);

/// How much of the liquid each rank should have so that none waits for another, relative to the most, of how
/// many particles a second each does. Ranks that differ by no more than measurements do get the same.
std::vector<double> balanced_shares(const std::vector<double>& speeds);

/// What the ranks above 0 do.
void follow_benchmark(const BenchmarkOptions& options);

}  // namespace kappaflow
