// Meshes as OBJ, PLY and binary glTF files, for programs that do not read VTK's.
#pragma once

#include <span>
#include <string>

#include "core/named.h"
#include "core/types.h"
#include "surface/measure/texture.h"

namespace kappaflow {

enum class MeshFormat { obj, ply, glb };

/// What the command line calls them, and how their files' names end.
inline constexpr Named<MeshFormat> kMeshFormats[] = {
    {"obj", MeshFormat::obj}, {"ply", MeshFormat::ply}, {"glb", MeshFormat::glb}};

/// A mesh with one entry a vertex in every array but the last.
struct TexturedMesh {
  std::span<const Vec3> position;  ///< [m]
  std::span<const Vec3> normal;    ///< outward, of length 1
  std::span<const Vec2> texture;   ///< texture coordinates in [0, 1]
  std::span<const Rgb> colour;
  std::span<const Triangle> triangles;
};

/// The bytes of a file. OBJ: text, with v (position and colour), vt, vn, and f v/vt/vn; positions to a
/// billionth of the mesh's size, wherever it is, as far as double precision has it. PLY: binary,
/// little-endian, with x y z in double precision, nx ny nz, s t, red green blue. GLB: see glb_bytes().
std::string mesh_bytes(MeshFormat format, const TexturedMesh& mesh);

}  // namespace kappaflow
