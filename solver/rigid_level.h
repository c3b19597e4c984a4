// One level of the multigrid for viscosity: cells of liquid that move as rigid bodies.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "solver/rank_cells.h"
#include "solver/rigid_motion.h"

namespace kappaflow {

/// Cubic cells of a grid, those that hold liquid, in Morton order, so that the 2x2x2 cells of a coarser one
/// follow each other. Each has a rigid motion m about its centre; neighbours, also across edges and corners,
/// are linked. The system is that of the particles for velocities that are rigid in each cell:
///   (A m)_I = K_I m_I + sum_J T_IJ^T S_IJ (m_I - m_J)   (all about from's centre in the bracket),
/// S_IJ the sum over the pairs of particles between two cells, K_I that over the cell's particles, of inertia
/// and walls. A common rigid motion of two cells costs nothing, whatever the rounding.
class RigidLevel {
 public:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  static constexpr int kBitsOfPlace = 21;       // a key has three of them
  static constexpr std::uint64_t kColours = 8;  // a cell's is the parity of its place: its key's last bits

  struct Link {
    std::uint32_t from, to;  // cells; `to` is one of the thirteen neighbours that come after `from`
  };

  static std::uint64_t key_of(const std::array<std::int64_t, 3>& place);
  static std::array<std::int64_t, 3> place_of(std::uint64_t key);
  static bool has_key(const std::array<std::int64_t, 3>& place);

  /// Where ranks share the liquid: from the keys of this rank's cells, which count from the place, to those
  /// of all that it lists.
  void share_among(Ranks& ranks, const LiquidCut& cut, const LiquidCut::Place& first_place);
  /// Sets the cells to those of `key`, ascending, and links them.
  void reset();
  /// Room for the sums over links and cells, which are not set.
  void make_room();
  /// Adds up the finer level's sums. Sets its cells' parents. False where there would be nothing to gain.
  bool coarsen(RigidLevel& finer);
  /// What relax_*() needs, once the sums stand. inertia: of a particle, see kPointInertia [m2].
  void invert(float inertia);

  std::size_t cells() const { return key.size(); }
  std::uint64_t colour(std::size_t cell) const { return key[cell] % kColours; }
  /// The cell of a key, or kNone.
  std::uint32_t find(std::uint64_t key_of_cell) const;
  /// Whether its row of the system is this rank's, and so its sums.
  bool is_own(std::size_t cell) const { return !ranks_ || ranks_->owns(cell); }
  double sum_of_ranks(double own) const { return ranks_ ? ranks_->ranks().sum(own) : own; }
  /// Gives others what this rank knows of its own cells, where ranks share them.
  template <class T>
  void share_values(std::vector<T>& values) {
    if (ranks_) ranks_->share(values);
  }

  /// The motions that half a round of block Gauss-Seidel finds for A motion = load from 0, by colours, which
  /// do not touch each other.
  void relax_from_zero();
  /// The coarser level's load is what relax_from_zero() has left of this one's.
  void restrict_to(RigidLevel& coarser) const;
  /// The other half, backwards, from any motions.
  void relax();
  /// Adds the coarser level's motion.
  void add_from(const RigidLevel& coarser);

  /// Whether the link, of an own cell, joins cells that resist each other.
  bool is_coupled(std::size_t link) const { return rigid::resists(coupling[link]); }
  /// The connected component of each cell, by its first cell, of the links for which counts(link).
  template <class Select>
  void find_components(std::vector<std::uint32_t>& root, const Select& counts) const;

  std::size_t bytes() const;

  std::vector<std::uint64_t> key;
  std::vector<Vec4f> centre;              ///< [m]; w: particles
  std::vector<std::uint32_t> first_link;  ///< of those from a cell; one more than cells
  std::vector<Link> links;
  std::vector<RigidMatrix> coupling;  ///< S of each link, about the centre of `from`
  std::vector<RigidMatrix> anchor;    ///< K of each cell
  std::vector<RigidVector> load, motion;

 private:
  void link_cells();
  void find_rows();
  void find_colours();
  void find_parents(RigidLevel& finer);
  void find_centres(const RigidLevel& finer);
  void gather_from(const RigidLevel& finer, std::size_t cell);
  void add_link(const RigidLevel& finer, std::size_t cell, std::uint32_t link, std::uint32_t other);
  Vec4f arm(std::uint32_t to, std::uint32_t from) const { return without_fourth(centre[to] - centre[from]); }
  std::span<const std::uint32_t> links_to(std::size_t cell) const {
    return {row_.data() + first_in_row_[cell], first_in_row_[cell + 1] - first_in_row_[cell]};
  }
  RigidMatrix diagonal(std::uint32_t cell) const;
  /// load - A motion at one cell, of the neighbours that count.
  template <class Select>
  RigidVector residual(std::uint32_t cell, const Select& counts) const;
  template <class Work>
  void relax_colour(std::uint64_t colour, const Work& work);

  std::optional<RankCells> ranks_;  // where they share the level's cells
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint32_t> first_child_;                 // in the finer level
  std::vector<std::uint32_t> first_in_row_, row_;          // the links to a cell
  std::vector<std::uint32_t> first_of_colour_, coloured_;  // of each colour first what others are told
  std::array<std::uint32_t, kColours> told_{};             // how many these are
  std::vector<std::uint32_t> end_;                         // of rows or colours, while they are filled
  std::vector<RigidMatrix> inverse_;
};

template <class Select>
void RigidLevel::find_components(std::vector<std::uint32_t>& root, const Select& counts) const {
  root.resize(cells());
  std::iota(root.begin(), root.end(), 0u);
  const auto root_of = [&](std::uint32_t cell) {
    while (root[cell] != cell) cell = root[cell] = root[root[cell]];
    return cell;
  };
  for (std::size_t k = 0; k < links.size(); ++k) {
    if (!counts(k)) continue;
    const auto [a, b] = std::minmax({root_of(links[k].from), root_of(links[k].to)});
    root[b] = a;
  }
  for (std::uint32_t cell = 0; cell < cells(); ++cell) root[cell] = root_of(cell);
}

}  // namespace kappaflow
