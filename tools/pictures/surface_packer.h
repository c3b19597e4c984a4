// Surfaces of one frame after another in few bytes, for pages that hold a whole run.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// One number a vertex.
struct PackedComponent {
  int bytes = 1;                     ///< 1 or 2 that a number has
  std::vector<std::uint16_t> value;  ///< one entry a vertex
};

/// A surface in whole numbers.
struct QuantisedSurface {
  std::vector<std::int64_t> id;             ///< of a vertex for as long as it lives
  std::vector<PackedComponent> components;  ///< as many, of as many bytes, in each frame
  std::vector<Triangle> triangles;
};

/// Packs the frames of one surface in their order. Most vertices and triangles are those of the last frame:
/// only what changes is written. All numbers are little-endian:
///   vertices, triangles that are new: 4 bytes each
///   a bit for each vertex of the last frame, and one for each triangle: whether it is still there
///   of each component the lowest bytes of all vertices, then those above
///   of the new triangles the lowest bytes of all first corners, then those above, 4 in all; then of the
///   second corners and the third
/// Vertices and triangles that stay keep their order, and come before those that are new. A component is
/// written as its difference, 2 |d| for d >= 0 and 2 |d| - 1 else, to the last frame's, of a new vertex to
/// that of the vertex before it (0 for the first). A new triangle's first corner is its smallest, written as
/// the difference to that of the triangle before it; its other corners as theirs to the first.
class SurfacePacker {
 public:
  std::string pack(const QuantisedSurface& surface);

 private:
  QuantisedSurface last_;  // in the order that it was written in
};

/// As browsers inflate it ("deflate", RFC 1950).
std::string deflated(std::string_view bytes);

/// RFC 4648, with padding.
std::string base64(std::string_view bytes);

}  // namespace kappaflow
