// Surfaces and particles as animated prims in USD text files.
//
// Each of them has a root (the .usda to open), value clips (a file a frame), and a manifest; run.usda
// composes the roots. The names and types are those that Blender takes: see docs/outputs.md.
#pragma once

#include <span>
#include <string>

#include "tools/io/mesh_formats.h"
#include "tools/io/point_data.h"
#include "tools/io/usd_text.h"

namespace kappaflow {

/// The files of an animated prim, relative to the root's folder.
struct UsdPrim {
  std::string name;      ///< in /World; usd_name() makes one that is allowed
  std::string stem;      ///< of the clips: STEM.0000.usda and so on
  std::string manifest;  ///< holds what usd_..._manifest() returns
  int frames = 0;        ///< from 0
};

/// A frame of a surface, a mesh: points, normals, velocities, extent, primvars st (faceVarying, indexed),
/// displayColor (linear), and of the mesh's arrays rest, rest_1, rest_2, rest_2_weight, id, source,
/// mean_curvature, gaussian_curvature, confidence and material_slip, as far as it has them.
std::string usd_surface_frame(int frame, const TexturedMesh& mesh, const Vec3& origin);
std::string usd_surface_manifest();
std::string usd_surface_root(const UsdStage& stage, const UsdPrim& prim);

/// A frame of particles: points, velocities, ids, primvar source, and widths: half of sigma, which is a
/// particle spacing by default.
std::string usd_particles_frame(int frame, const PointData& particles, const Vec3& origin);
std::string usd_particles_manifest();
std::string usd_particles_root(const UsdStage& stage, const UsdPrim& prim);

}  // namespace kappaflow
