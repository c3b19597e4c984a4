// How deep in the liquid particles are, without more of them in memory than a piece of a frame.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/space_cell.h"
#include "core/types.h"
#include "solver/ranks.h"
#include "tools/io/input_frame.h"

namespace kappaflow {

/// The sum of Eq. 12's kernels on a sparse lattice, half a sigma wide, and what follows from it: some 5 bytes
/// a particle while particles are added, and one after that, where they are as dense as usual. One that is
/// alone takes some 10 KB; where the lattice takes more than a gigabyte and the particles themselves would,
/// there is no depth to speak of, it is given up, and all is near a surface: of ranks, where it is one's own.
class LiquidDepth {
 public:
  /// sigma: support radius [m]. free: what the lattice may take whatever is in it [bytes].
  explicit LiquidDepth(double sigma, std::size_t free = std::size_t{1} << 30)
      : step_(0.5 * sigma), free_(free) {}

  void add(std::span<const Vec3> position);
  void add(LiquidDepth others);  ///< particles, of a liquid with the same sigma

  /// Whether it is given up.
  bool scattered() const { return scattered_; }
  /// Once all particles are added. ranks: that have added particles of one liquid, all of which call it; each
  /// then knows the zones around its own.
  void measure(Ranks* ranks = nullptr);

  /// Not passing: nothing is known of other frames.
  Zone zone(const Vec3& x) const;
  /// The cube that x, which is deep or deepest, is in, and how far from its middle it is, squared [m2].
  std::uint64_t cube(const Vec3& x, Zone zone) const;
  double squared_distance_from_middle(const Vec3& x, Zone zone) const;
  /// What the sum is inside.
  double inside() const { return inside_; }
  std::size_t bytes() const;

 private:
  static constexpr int kSide = 8;  // nodes of a block
  static constexpr std::size_t kNodes = kSide * kSide * kSide;
  using Node = std::array<std::int64_t, 3>;
  using Sums = std::array<float, kNodes>;
  using Marks = std::array<std::uint8_t, kNodes>;
  struct SharedBlock {
    Node block;
    Sums sums;
  };

  static std::uint64_t key_of(const Node& block);
  Node node_at(const Vec3& x) const;
  void add(const Vec3& x);
  void give_up();
  void forget();
  Sums& sums_of(const Node& block);
  void share(Ranks& ranks);
  std::vector<std::vector<SharedBlock>> blocks_for(Ranks& ranks) const;
  void add(std::span<const SharedBlock> blocks, int rank);
  void find_inside(Ranks* ranks);

  void dilate(int axis, int radius, const std::vector<Marks>& from, std::vector<Marks>& to) const;
  static void fit_to_cubes(Marks& zones);

  double step_;  // [m]
  std::size_t free_, added_ = 0;
  bool scattered_ = false;
  double inside_ = 0;
  std::unordered_map<std::uint64_t, std::uint32_t> block_of_;
  std::vector<Node> block_;
  std::deque<Sums> sums_;   // grow without a copy
  std::vector<int> first_;  // by block, where ranks share the liquid: the first of those that have some in it

  std::vector<Marks> zones_;
};

}  // namespace kappaflow
