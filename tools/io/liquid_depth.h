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
#include "tools/io/input_frame.h"

namespace kappaflow {

/// The sum of Eq. 12's kernels on a sparse lattice, half a sigma wide, and what follows from it: some 5 bytes
/// a particle while particles are added, and one after that, where they are as dense as usual. One that is
/// alone takes some 10 KB; where the lattice takes more than a gigabyte and the particles themselves would,
/// there is no depth to speak of, it is given up, and all is near a surface.
class LiquidDepth {
 public:
  /// sigma: support radius [m]. free: what the lattice may take whatever is in it [bytes].
  explicit LiquidDepth(double sigma, std::size_t free = std::size_t{1} << 30)
      : step_(0.5 * sigma), free_(free) {}

  void add(std::span<const Vec3> position);
  /// Whether it is given up.
  bool scattered() const { return scattered_; }
  /// Once all particles are added.
  void measure();

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
  using Marks = std::array<std::uint8_t, kNodes>;

  static std::uint64_t key_of(const Node& block);
  Node node_at(const Vec3& x) const;
  void add(const Vec3& x);
  void give_up();
  std::array<float, kNodes>& sums_of(const Node& block);
  void find_inside();
  void dilate(int axis, int radius, const std::vector<Marks>& from, std::vector<Marks>& to) const;
  static void fit_to_cubes(Marks& zones);

  double step_;  // [m]
  std::size_t free_, added_ = 0;
  bool scattered_ = false;
  double inside_ = 0;
  std::unordered_map<std::uint64_t, std::uint32_t> block_of_;
  std::vector<Node> block_;
  std::deque<std::array<float, kNodes>> sums_;  // grow without a copy
  std::vector<Marks> zones_;
};

}  // namespace kappaflow
