// How a mesh follows the surface's topology, and what was done for it.
#pragma once

#include <cstddef>

namespace kappaflow {

struct TopologyOptions {
  bool follows_field = false;  ///< whether the mesh's topology follows the surface's
  /// Of the lattice, as a share of Field::length_scale(); smaller pieces, holes and gaps may be missed.
  double spacing = 0.25;
  int lattice_interval = 8;  ///< steps from one comparison with the whole lattice to the next, >= 1
};

/// What one change of topology did.
struct TopologyCounts {
  std::size_t replaced = 0;           ///< regions that were replaced
  std::size_t refused = 0;            ///< regions that were left as they were
  std::size_t triangles_removed = 0;  ///< in the former
  std::size_t vertices_born = 0;      ///< vertices that are new afterwards
  std::size_t vertices_lost = 0;      ///< vertices that are gone afterwards

  TopologyCounts& operator+=(const TopologyCounts& other) {
    replaced += other.replaced;
    refused += other.refused;
    triangles_removed += other.triangles_removed;
    vertices_born += other.vertices_born;
    vertices_lost += other.vertices_lost;
    return *this;
  }

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(replaced, refused, triangles_removed, vertices_born, vertices_lost);
  }
};

}  // namespace kappaflow
