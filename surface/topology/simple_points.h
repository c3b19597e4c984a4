// Digital topology: which points of a lattice may change sides without a change of topology.
#pragma once

#include <cstdint>

namespace kappaflow {

/// The 26 neighbours of a lattice's point and the point itself, one bit each: bit 9 (k + 1) + 3 (j + 1) + i +
/// 1 for the one at offset (i, j, k); 1 inside.
using Neighbourhood = std::uint32_t;

/// Of the points at offsets (i, j, k), -1 to 1 each; is_inside(i, j, k).
template <class Test>
Neighbourhood neighbourhood(const Test& is_inside) {
  Neighbourhood inside = 0;
  int bit = 0;
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i, ++bit) inside |= (is_inside(i, j, k) ? 1u : 0u) << bit;
  return inside;
}

/// Whether the point may change sides without joining, parting, opening or filling anything: it is a simple
/// point (Bertrand & Malandain, "A new characterization of three-dimensional simple points", 1994) where the
/// inside is connected across corners, or across edges, and the outside across faces, and the other way
/// round. An isosurface of marching cubes connects across the edges of the one or the other.
bool is_simple(Neighbourhood inside);

}  // namespace kappaflow
