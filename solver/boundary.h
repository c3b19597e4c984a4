// Walls in the solver's equations: Akinci, Ihmsen, Akinci, Solenthaler & Teschner, "Versatile rigid-fluid
// coupling for incompressible SPH" (2012).
#pragma once

#include <span>
#include <vector>

#include "core/cell_grid.h"
#include "solver/fluid_particles.h"
#include "solver/kernel.h"

namespace kappaflow {

/// What the walls contribute to each liquid particle. The walls stand still and mirror the particle's own
/// pressure, so these sums over the wall particles b are constant within a step and the solvers' loops have
/// no wall pairs.
struct WallSums {
  std::vector<Mat43f>
      friction;               ///< sum_b c_ib x_ib x_ib^T [1/m2] with c of viscosity.h; zero away from walls
  std::vector<char> touches;  ///< whether any wall particle is within the support
};

/// The wall particles with their volumes, and the search for them.
class Walls {
 public:
  /// position: as sample_walls() gives them [m]
  Walls(std::span<const Vec3> position, float spacing);

  std::size_t size() const { return samples_.size(); }

  /// Fills `sums` and adds to particles.density, gradient_sum the walls' part. Precondition: both hold the
  /// liquid's.
  void add_to(FluidParticles& particles, WallSums& sums) const;

 private:
  void add_to(std::size_t i, FluidParticles& particles, WallSums& sums) const;

  CubicSpline kernel_;
  CellGrid grid_;
  std::vector<Vec4f> samples_;  // in cell order; w: volume [m3]
};

}  // namespace kappaflow
