// Level sets that the liquid on the staircase moves, beside the surfaces that are tracked on it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/experiments/experiment.h"

namespace kappaflow {

struct StaircaseOptions {
  std::filesystem::path scene;
  std::vector<std::string> methods;
  std::vector<double> spacings;  ///< of the grids [sigma]
  std::vector<double> times;     ///< when surfaces are compared with the particles' [s], ascending
};

/// Simulates the scene, moves its surfaces and a level set of each scheme and spacing in the particles'
/// velocity, and compares all with the isosurface of the particles.
Table staircase_table(const ExperimentContext& context, const StaircaseOptions& options);

}  // namespace kappaflow
