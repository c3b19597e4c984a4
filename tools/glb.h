// Meshes as binary glTF 2.0.
#pragma once

#include <string>

#include "tools/mesh_text.h"

namespace kappaflow {

/// The bytes of a .glb file: one mesh with POSITION, NORMAL, TEXCOORD_0 and COLOR_0, a matt material, and no
/// scene where the mesh has no triangles, which glTF does not allow. As glTF has it, texture coordinates
/// count from the image's upper edge and colours are linear.
std::string glb_bytes(const TexturedMesh& mesh);

}  // namespace kappaflow
