// A multilevel preconditioner for viscosity, whose coarse spaces are the rigid motions of cells of liquid.
#pragma once

#include <cstdint>
#include <vector>

#include "solver/boundary.h"
#include "solver/fluid_particles.h"
#include "solver/neighbours.h"
#include "solver/rigid_level.h"
#include "solver/viscous_forces.h"

namespace kappaflow {

/// xx, yy, zz, yz, xz, xy
using SymmetricMatrix = std::array<float, 6>;

/// M^-1 = D^-1 + P C P^T for the system A = I + dt L (see viscous_forces.h): D are A's 3x3 diagonal blocks, P
/// takes rigid motions of cells to velocities, C is one V-cycle on P^T A P, whose coarser levels are the
/// rigid motions of 2x2x2 cells. Symmetric and positive definite. Rigid motions of free liquid cost no
/// viscous stress: they are what D alone is slow to find. See docs/viscosity.md.
class RigidMultigrid {
 public:
  /// Width of the finest cells [spacings]. Of two cells of the neighbour grid, by which particles are sorted:
  /// runs of particles are then long. More than the kernel's support: only neighbours touch.
  static constexpr double kCellWidth = 4;

  explicit RigidMultigrid(double spacing);

  /// Of the particles that can change their velocity by viscosity: they are not led, and viscous.
  void build(const ViscousForces& forces, const FluidParticles& particles, const NeighbourLists& lists,
             const WallSums& walls, float time_step);

  /// Finds the cells' motions C P^T r, for r one vector a particle.
  void solve(const FluidParticles& particles, const std::vector<Vec4f>& r);
  /// (M^-1 r)_i, after solve(); 0 for particles that take no part.
  Vec4f times(const FluidParticles& particles, const std::vector<Vec4f>& r, std::size_t i) const;

  bool takes_part(std::size_t i) const { return cell_of_[i] != RigidLevel::kNone; }
  /// Where the particle takes part.
  std::uint32_t cell_of(std::size_t i) const { return cell_of_[i]; }
  /// The connected component of each cell, by its first cell.
  std::vector<std::uint32_t> components() const { return finest().components(!weak_); }
  bool any_led() const { return any_led_; }
  double spacing() const { return spacing_; }
  const RigidLevel& finest() const { return levels_.front(); }
  /// Calls visit(i) for the particles of a cell that take part.
  template <class Visit>
  void for_particles(std::size_t cell, const Visit& visit) const {
    for (std::uint32_t k = first_run_[cell]; k < first_run_[cell + 1]; ++k)
      for (std::uint32_t i = runs_[k].begin; i < runs_[k].end; ++i) visit(i);
  }

  std::size_t bytes() const;

 private:
  /// Particles [begin, end), all in the cell.
  struct Run {
    std::uint64_t key;
    std::uint32_t begin, end;
  };
  class WideSquares;
  class CellSums;

  void find_runs(const ViscousForces& forces, const FluidParticles& particles);
  void find_cells();
  void find_centre(const FluidParticles& particles, std::size_t cell);

  double spacing_;
  Vec4f lower_ = Vec4f::Zero();  // corner of the grid [m]
  std::vector<Run> runs_;
  std::vector<std::uint32_t> first_run_;  // of a cell
  std::vector<std::uint32_t> cell_of_;    // by particle; kNone: takes no part
  std::vector<SymmetricMatrix> inverse_diagonal_;
  std::vector<RigidLevel> levels_;  // from fine to coarse
  std::size_t depth_ = 0;           // levels in use; 0: M is D
  bool any_led_ = false;
  bool weak_ = false;  // viscosity: D^-1 alone is as good, and cells that touch are not coupled
};

}  // namespace kappaflow
