// The triangles that close the gap between two boundary loops of a mesh, or within one.
#pragma once

#include <span>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// Triangles between two loops that run side by side: they hold the edges of `from` as they run and those of
/// `to` against their run. Among all such strips that start at the shortest distance between the loops, the
/// one of least cost (Fuchs, Kedem, Uselton 1977), each triangle costing its longest edge squared, more the
/// less it faces along the gradients' opposites. gradient: of f at the vertices.
std::vector<Triangle> strip_between(std::span<const Vec3> position, std::span<const Vec3> gradient,
                                    std::span<const int> from, std::span<const int> to);

/// Triangles over the corners of one loop that hold its edges as they run, of least cost (Barequet & Sharir
/// 1995).
std::vector<Triangle> fill_loop(std::span<const Vec3> position, std::span<const Vec3> gradient,
                                std::span<const int> loop);

}  // namespace kappaflow
