// What remeshing aims at, and what it did.
#pragma once

#include <cstddef>

namespace kappaflow {

/// The edge length aimed at is clamp(turn / kappa, finest edge_length, edge_length), kappa the largest normal
/// curvature of the surface.
struct RemeshOptions {
  double edge_length = 0;  ///< where the surface is flat [m]; 0: the mesh keeps its connectivity
  double turn = 0.5;       ///< angle by which the normal turns along an edge of the length aimed at [rad]
  double finest = 0.5;     ///< smallest edge length, as a share of edge_length, (0, 1]
};

/// What one remeshing did.
struct RemeshCounts {
  std::size_t splits = 0, collapses = 0, flips = 0;
  std::size_t replaced = 0;  ///< vertices that a new one at a better place stands for
  double residual_max = 0;   ///< Projected::residual of the new vertices

  bool any() const { return splits + collapses + flips + replaced > 0; }
  RemeshCounts& operator+=(const RemeshCounts& other) {
    splits += other.splits;
    collapses += other.collapses;
    flips += other.flips;
    replaced += other.replaced;
    residual_max = residual_max > other.residual_max ? residual_max : other.residual_max;
    return *this;
  }

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(splits, collapses, flips, replaced, residual_max);
  }
};

}  // namespace kappaflow
