// What surfaces and particles take along into the files of other programs.
#pragma once

#include <vtkPolyData.h>

#include <cstdint>
#include <vector>

#include "core/types.h"
#include "surface/measure/texture.h"
#include "tools/io/mesh_formats.h"
#include "tools/io/point_data.h"

namespace kappaflow {

/// How rest positions become texture coordinates.
struct TextureMap {
  Bounds box;  ///< of the first mesh's rest positions
  TextureProjection projection = TextureProjection::box;
};

/// A surface as a TexturedMesh refers to it.
struct ExportedSurface {
  std::vector<Vec3> position, normal, rest;  ///< rest positions, positions where there are none
  SeamlessTexture texture;
  std::vector<Rgb> colour;
  std::vector<Triangle> triangles;
  std::vector<PointArray> arrays;

  TexturedMesh mesh(bool z_up) const;
};

/// Points with their arrays. Ids are whole numbers, rest positions have double precision and are called rest,
/// all other real numbers have single precision. data: from particle_data() or surface_data(), or read back.
PointData exported_points(vtkPolyData& data);

/// A surface with the arrays that it has beside those that every mesh file has. Where it has no checker it is
/// grey. surface: from surface_data(), or read back; the result is the same.
ExportedSurface exported_surface(vtkPolyData& surface, const TextureMap& map);

/// The walls of boundary_data(), in their order, or those that were read back.
std::vector<TriangleSurface> exported_walls(vtkPolyData& boundary);

/// rest, rest_1 or rest_2: places, which count from the origin that positions count from.
bool is_rest_position(const PointArray& array);

/// A whole number as formats without 64 bits have it: modulo 2^31 where it is larger, as no id is yet.
std::int32_t whole_of_32_bits(double value);

/// sRGB as linear light, in [0, 1].
double linear_light(std::uint8_t channel);

/// What positions in single precision are stored from: seven digits, of which a mesh far from the origin
/// would waste most on where it is. The middle of such a mesh, as a number of single precision; else the
/// origin.
Vec3 far_origin(std::span<const Vec3> position);

}  // namespace kappaflow
