// Colours and texture coordinates that are painted on the initial mesh and travel with its vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/named.h"
#include "core/types.h"
#include "surface/field/field.h"

namespace kappaflow {

enum class TextureProjection { planar, spherical, box };
/// As scenes and run.json have them.
inline constexpr Named<TextureProjection> kTextureProjections[] = {
    {"planar", TextureProjection::planar},
    {"spherical", TextureProjection::spherical},
    {"box", TextureProjection::box}};

using Rgb = std::array<std::uint8_t, 3>;

/// A solid checker: space cut into cubes.
struct Checker {
  Vec3 origin = Vec3::Zero();  ///< a corner of cubes [m]
  double edge = 1;             ///< of a cube [m]
};

/// The checker for a first mesh whose outward unit normals are given, with cubes that lie along the axes:
/// moved so that parts of the surface that face along an axis are as far from the cubes' faces as can be (a
/// face of the checker in a face of the liquid would be noise).
Checker checker_beside(std::span<const Vec3> position, std::span<const Vec3> normal, double edge);

/// A vertex has the colour of the cube floor((rest_position - origin) / edge) that it lay in at the start:
/// cream where the sum of the three indices is even, blue where it is odd. Each cube differs a little in
/// brightness, so that the eye can tell cubes apart and sees a surface turn.
std::vector<Rgb> checker_colours(std::span<const Vec3> rest_position, const Checker& checker);

/// The bounding box of the first mesh's vertices, which texture coordinates refer to.
Bounds bounding_box(std::span<const Vec3> position);

/// Texture coordinates in [0, 1]^2 by projecting rest positions, relative to the first mesh's bounding box:
/// planar: (x, y) over the box's extents. spherical: longitude about +y and latitude, seen from the box's
/// centre. box: onto the face of the box that the point is nearest to, each face covering the whole texture.
std::vector<Vec2> texture_coordinates(std::span<const Vec3> rest_position, const Bounds& box,
                                      TextureProjection projection);

}  // namespace kappaflow
