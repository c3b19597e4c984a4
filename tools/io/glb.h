// Meshes as binary glTF 2.0.
#pragma once

#include <cstddef>
#include <string>

#include "tools/io/mesh_formats.h"

namespace kappaflow {

/// Throws InvalidInput for a mesh that is too large for the format, whose lengths have 32 bits.
/// further_numbers: of a vertex, beside position, normal, texture coordinates and colour.
void check_glb_size(std::size_t vertices, std::size_t triangles, std::size_t further_numbers = 0);

/// The bytes of a .glb file: one mesh with POSITION, NORMAL, TEXCOORD_0 and COLOR_0, the mesh's arrays as
/// _NAME in single precision, a matt material, and no scene where the mesh has no triangles, which glTF does
/// not allow. A vertex with several texture coordinates is one vertex for each. As glTF has it, texture
/// coordinates count from the image's upper edge, colours are linear, y is up (the node turns a mesh with z
/// up), and positions are in single precision: those of a mesh far from the origin are from its middle, which
/// is the node's translation; so is `rest`. Throws as check_glb_size().
std::string glb_bytes(const TexturedMesh& mesh);

}  // namespace kappaflow
