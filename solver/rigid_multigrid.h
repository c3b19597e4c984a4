// A multilevel preconditioner for viscosity, whose coarse spaces are the rigid motions of cells of liquid.
#pragma once

#include <cstdint>
#include <vector>

#include "core/parallel.h"
#include "solver/boundary.h"
#include "solver/fluid_particles.h"
#include "solver/lanes.h"
#include "solver/neighbours.h"
#include "solver/rigid_level.h"
#include "solver/viscous_forces.h"

namespace kappaflow {

/// M^-1 = D^-1 + P C P^T for the system A = m + dt L (see viscosity.h): D are A's 3x3 diagonal blocks, P
/// takes rigid motions of cells to velocities, C is one V-cycle on P^T A P, whose coarser levels are the
/// rigid motions of 2x2x2 cells. Symmetric and positive definite. Rigid motions of free liquid cost no
/// viscous stress: they are what D alone is slow to find. See docs/viscosity.md.
class RigidMultigrid {
 public:
  /// Width of the finest cells [spacings]. Of two cells of the neighbour grid, by which particles are sorted:
  /// runs of particles are then long. More than the kernel's support: only neighbours touch.
  static constexpr double kCellWidth = 4;

  explicit RigidMultigrid(double spacing);

  /// The first step of build(), after which is_weak() answers.
  void find_weak(const ViscousForces& forces, float time_step);
  /// Of the particles that can change their velocity by viscosity: they are not led, and viscous. Their
  /// (L v)_i, which come of the same loop over pairs, go to `resistance`.
  void build(const ViscousForces& forces, const FluidParticles& particles, const NeighbourLists& lists,
             const WallSums& walls, float time_step, const std::vector<Vec4f>& v,
             std::vector<Vec4f>& resistance);

  /// M^-1 r in three steps, r one vector a particle: restrict_to() for every cell, solve(), for_solutions()
  /// for every cell. The first: P^T r of one cell. Returns r . D^-1 r of its particles.
  double restrict_to(std::size_t cell, const FluidParticles& particles, const std::vector<Vec4f>& r);
  /// The second: finds the motions m = C P^T r. Returns r . P m.
  double solve();
  /// The third: calls visit(i, (M^-1 r)_i) for the particles of a cell.
  template <class Visit>
  void for_solutions(std::size_t cell, const FluidParticles& particles, const std::vector<Vec4f>& r,
                     const Visit& visit) const;
  /// (D^-1 r)_i.
  Vec4f block_times(std::size_t i, const Vec4f& r) const {
    return rigid::product(inverse_diagonal_[i].data(), r);
  }

  /// The connected component of each cell, by the key of its first cell; where ranks share the liquid, of
  /// those that this one lists.
  void find_components(std::vector<std::uint64_t>& component);
  /// Whether the link is one of those that connect. Where ranks share the liquid: of this rank's cells only.
  bool is_connected(std::size_t link) const;
  /// Tells other ranks what this one knows of its own cells.
  template <class T>
  void share_values(std::vector<T>& values) {
    levels_.front().share_values(values);
  }
  /// A point in or near a finest cell, the same on all ranks, whether they list it or not [m].
  Vec3 point_of(std::uint64_t key) const;
  /// Whether viscosity changes the fluid's velocity little in a step.
  bool is_weak(std::size_t fluid) const { return weak_fluid_[fluid] != 0; }
  bool any_led() const { return any_led_; }
  double spacing() const { return spacing_; }
  const RigidLevel& finest() const { return levels_.front(); }
  std::size_t cells() const { return finest().cells(); }
  /// Calls visit(i) for the particles of a cell that take part.
  template <class Visit>
  void for_particles(std::size_t cell, const Visit& visit) const {
    for (std::uint32_t k = first_run_[cell]; k < first_run_[cell + 1]; ++k)
      for (std::uint32_t i = runs_[k].begin; i < runs_[k].end; ++i) visit(i);
  }
  /// Calls work(cell), in parallel.
  template <class Work>
  void for_cells(const Work& work) const {
    parallel_for(cells(), work, kCellGrain);
  }
  /// Sum over the cells of value(cell).
  template <class T, class Value>
  T sum_over_cells(const T& zero, const Value& value) const {
    return parallel_sum(cells(), zero, value, kCellGrain);
  }

  std::size_t bytes() const;

 private:
  /// Particles [begin, end), all in the cell.
  struct Run {
    std::uint64_t key;
    std::uint32_t begin, end;
  };
  class CellSums;
  static constexpr std::size_t kCellGrain = 4;  // cells that a task works on

  void find_corner(const FluidParticles& particles);
  void find_runs(const ViscousForces& forces, const FluidParticles& particles);
  void find_cells(const Halo* halo);
  void find_centre(const FluidParticles& particles, std::size_t cell);
  /// Whether the particle moves with its cell.
  bool is_carried(std::size_t i, const FluidParticles& particles) const {
    return !any_weak_ || !is_weak(particles.fluid[i]);
  }
  /// From the cell's centre.
  Vec4f arm(std::size_t cell, const Vec4f& x) const { return without_fourth(x - finest().centre[cell]); }

  double spacing_;
  Vec4f lower_ = Vec4f::Zero();                // corner of the grid [m]
  std::array<std::int64_t, 3> first_place_{};  // place in it from which the cells' count
  std::vector<Run> runs_;
  std::vector<std::uint32_t> first_run_;  // of a cell
  std::vector<std::uint32_t> root_;       // of the component of each cell, its first cell
  std::vector<SymmetricMatrix> inverse_diagonal_;
  std::vector<RigidLevel> levels_;  // from fine to coarse
  std::size_t depth_ = 0;           // levels in use; 0: M is D
  bool shared_ = false;             // ranks share the liquid: of other ranks' cells no particles are here
  bool any_led_ = false;
  // Where viscosity is weak, D^-1 alone is as good. If all is, there are no levels; if some is, its particles
  // do not move with the cells, which else would hold two bodies, a stiff one and what flows around it.
  bool weak_ = false, any_weak_ = false;
  std::vector<char> weak_fluid_;
};

template <class Visit>
void RigidMultigrid::for_solutions(std::size_t cell, const FluidParticles& particles,
                                   const std::vector<Vec4f>& r, const Visit& visit) const {
  if (depth_ == 0) return for_particles(cell, [&](std::size_t i) { visit(i, block_times(i, r[i])); });
  const RigidVector motion = finest().motion[cell];
  for_particles(cell, [&](std::size_t i) {
    const Vec4f own = block_times(i, r[i]);
    if (!is_carried(i, particles)) return visit(i, own);
    visit(i, own + (motion.linear + cross(motion.angular, arm(cell, particles.position[i]))));
  });
}

}  // namespace kappaflow
