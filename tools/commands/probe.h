// `kappaflow probe`: the field, its derivatives, curvatures and velocities at given points.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "surface/field/kernel_shapes.h"

namespace kappaflow {

struct ProbeOptions {
  std::filesystem::path
      particles;  ///< .vtp (arrays velocity, weight, sigma) or .csv (x,y,z,vx,vy,vz,weight,sigma)
  std::filesystem::path points;      ///< .csv (x,y,z)
  double threshold = 0;              ///< T of Eq. 12
  std::vector<std::string> methods;  ///< names of velocity methods
  Kernels kernels = Kernels::round;
};

/// A CSV table with a row a point, 17 digits. Curvatures are nan where the gradient of f vanishes.
/// Throws InvalidInput, IoError.
std::string probe(const ProbeOptions& options);

}  // namespace kappaflow
