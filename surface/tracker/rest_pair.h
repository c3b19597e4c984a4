// Two rest positions that are reset in turns: texture coordinates of bounded age.
#pragma once

#include <array>

#include "surface/tracker/surface_group.h"

namespace kappaflow {

/// A texture on rest_position is stretched as far as the liquid was since the start. Where that is beyond
/// recognition, one blends two, as is usual in film: each is the position in the mesh some frames ago, and
/// while one is reset only the other is seen. In frame n, with s = n/interval,
///   rest_1  was reset at the last even s,
///   rest_2  at the last odd one,
///   colour = (1 - w) texture(rest_1) + w texture(rest_2),  w = |1 - (s mod 2)|,
/// so that no rest position that is seen is older than two intervals. Registers the arrays rest_1, rest_2 [m]
/// and rest_2_weight (w) of all surfaces.
class RestPair {
 public:
  /// In frame 0. interval: frames from a reset to the next, which is the other's, >= 1.
  RestPair(SurfaceGroup& surfaces, int interval);

  /// To be called in every frame from the first on, when its surfaces are settled.
  void update(SurfaceGroup& surfaces, int frame);

  /// The mesh's bounding box when rest_1 (0) or rest_2 (1) was reset last: for texture_coordinates().
  const Bounds& box(int which) const { return box_[which]; }
  static constexpr std::array<const char*, 2> kNames{"rest_1", "rest_2"};

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    for (Bounds& box : box_) archive(box.lower, box.upper);
  }

 private:
  void reset(SurfaceGroup& surfaces, int which);

  int interval_;
  std::array<Bounds, 2> box_;
};

}  // namespace kappaflow
