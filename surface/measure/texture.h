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

/// Texture coordinates with a choice for each corner of a triangle.
struct SeamlessTexture {
  std::vector<Vec2> value;        ///< first those of texture_coordinates(), one a vertex, then further ones
  std::vector<Triangle> corners;  ///< of each triangle: the entries of `value` at its corners
};

/// The same without seams, where a triangle's corners would have coordinates from two ends of the texture.
/// box: all corners of a triangle are projected onto the face that its centroid is nearest to, a little
/// beyond [0, 1] perhaps. spherical: longitudes that are more than half a turn apart differ by less when the
/// smaller one is counted on: up to 1.5; textures repeat. planar has no seams.
SeamlessTexture seamless_texture(std::span<const Vec3> rest_position, std::span<const Triangle> triangles,
                                 const Bounds& box, TextureProjection projection);

}  // namespace kappaflow
