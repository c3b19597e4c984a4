// Meshes as OBJ, PLY and binary glTF files, for programs that do not read VTK's.
#pragma once

#include <span>
#include <string>

#include "core/named.h"
#include "core/types.h"
#include "surface/measure/texture.h"
#include "tools/io/point_data.h"

namespace kappaflow {

enum class MeshFormat { obj, ply, glb, usd };

/// What the command line calls them.
inline constexpr Named<MeshFormat> kMeshFormats[] = {
    {"obj", MeshFormat::obj}, {"ply", MeshFormat::ply}, {"glb", MeshFormat::glb}, {"usd", MeshFormat::usd}};

/// A mesh with one entry a vertex in every array but the last four.
struct TexturedMesh {
  std::span<const Vec3> position;  ///< [m]
  std::span<const Vec3> normal;    ///< outward, of length 1
  std::span<const Vec2> texture;   ///< texture coordinates; where there are `corners`, further ones behind
  std::span<const Rgb> colour;
  std::span<const Triangle> triangles;
  std::span<const Triangle> corners{};   ///< of each triangle: entries of `texture`; empty: its vertices
  std::span<const PointArray> arrays{};  ///< whatever else there is to say of a vertex
  bool z_up = false;                     ///< instead of y, for formats that say what is up
};

/// The bytes of an OBJ, PLY or GLB file; USD files, which hold many meshes: see usd_file.h.
/// OBJ: text, with v (position and colour), vt, vn, and f v/vt/vn; positions to a billionth of the mesh's
/// size, wherever it is, as far as double precision has it. PLY: binary, little-endian, with x y z in double
/// precision, nx ny nz, s t (one a vertex), red green blue, and the arrays, vectors as NAME_x NAME_y NAME_z.
/// GLB: see glb_bytes().
std::string mesh_bytes(MeshFormat format, const TexturedMesh& mesh);

}  // namespace kappaflow
