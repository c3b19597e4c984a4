// Colours and texture coordinates that are painted on the initial mesh and travel with its vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"
#include "surface/field/field.h"

namespace kappaflow {

enum class TextureProjection { planar, spherical, box };

using Rgb = std::array<std::uint8_t, 3>;

/// A solid checker: space is cut into cubes with the given edge [m], and a vertex has the colour of the cube
/// floor(rest_position / edge) that it lay in at the start: cream where the sum of the three indices is even,
/// blue where it is odd. Each cube differs a little in brightness, so that the eye can tell cubes apart and
/// sees a surface turn.
std::vector<Rgb> checker_colours(std::span<const Vec3> rest_position, double edge);

/// The bounding box of the first mesh's vertices, which texture coordinates refer to.
Bounds bounding_box(std::span<const Vec3> position);

/// Texture coordinates in [0, 1]^2 by projecting rest positions, relative to the first mesh's bounding box:
/// planar: (x, y) over the box's extents. spherical: longitude about +y and latitude, seen from the box's
/// centre. box: onto the face of the box that the point is nearest to, each face covering the whole texture.
std::vector<Vec2> texture_coordinates(std::span<const Vec3> rest_position, const Bounds& box,
                                      TextureProjection projection);

}  // namespace kappaflow
