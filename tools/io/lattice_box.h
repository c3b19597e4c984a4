// Boxes of points on a lattice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace kappaflow {

/// The points first[c] to last[c] along x, y and z, both included; none where last < first.
struct LatticeBox {
  std::array<std::int64_t, 3> first{}, last{};

  bool operator==(const LatticeBox&) const = default;
  bool empty() const;
  /// Along each axis. Precondition: not empty.
  std::array<std::size_t, 3> points() const;
  /// Of one of its points, along x first.
  std::size_t index(std::int64_t i, std::int64_t j, std::int64_t k) const;
  bool contains(const LatticeBox& part) const;
  LatticeBox common_with(const LatticeBox& other) const;
};

/// Points of a box that none of the parts has; nullopt where they have them all. Parts may overlap.
std::optional<LatticeBox> gap_between(const LatticeBox& whole, std::span<const LatticeBox> parts);

}  // namespace kappaflow
