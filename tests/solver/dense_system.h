// The viscous system as a dense matrix, for tests that solve it another way.
#pragma once

#include "solver/viscosity.h"
#include "tests/solver/liquid.h"

namespace kappaflow::test {

/// m + dt L, column by column.
inline Eigen::MatrixXd dense_system(const Liquid& liquid, float time_step, const ViscositySolver& solver) {
  const std::size_t n = liquid.particles.size();
  Eigen::MatrixXd matrix(3 * n, 3 * n);
  std::vector<Vec4f> image;
  for (std::size_t column = 0; column < 3 * n; ++column) {
    std::vector<Vec4f> unit(n, Vec4f::Zero());
    unit[column / 3][static_cast<Eigen::Index>(column % 3)] = 1;
    solver.apply(liquid.particles, liquid.lists, liquid.wall_sums, time_step, unit, image);
    for (std::size_t i = 0; i < n; ++i)
      matrix.block<3, 1>(3 * static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(column)) =
          image[i].head<3>().cast<double>();
  }
  return matrix;
}

/// One after another.
inline Eigen::VectorXd stacked(const std::vector<Vec4f>& u) {
  Eigen::VectorXd v(3 * u.size());
  for (std::size_t i = 0; i < u.size(); ++i)
    v.segment<3>(3 * static_cast<Eigen::Index>(i)) = u[i].head<3>().cast<double>();
  return v;
}

}  // namespace kappaflow::test
