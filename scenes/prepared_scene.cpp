#include "scenes/prepared_scene.h"

#include <utility>
#include <variant>

#include "core/text_hash.h"
#include "scenes/fill.h"
#include "scenes/mesh_file.h"
#include "scenes/shapes.h"

namespace kappaflow {
namespace {

/// A wall's closed surface, oriented outward.
struct WallSurface {
  MeshFiles& meshes;
  const SourcePosition& where;

  TriangleSurface operator()(const BoxShape& box) const { return box_surface(box); }
  TriangleSurface operator()(const SphereShape& sphere) const { return sphere_surface(sphere); }
  TriangleSurface operator()(const CylinderShape& cylinder) const { return cylinder_surface(cylinder); }
  TriangleSurface operator()(const BasinShape& basin) const { return basin_surface(basin); }
  TriangleSurface operator()(const StairsShape& stairs) const { return stairs_surface(stairs); }
  TriangleSurface operator()(const MeshShape& mesh) const { return meshes.surface(mesh, where); }
};

std::vector<SolidWall> walls_of(const Scene& scene, MeshFiles& meshes) {
  std::vector<SolidWall> walls;
  for (const Wall& wall : scene.walls)
    walls.emplace_back(std::visit(WallSurface{meshes, wall.where}, wall.shape), wall.motion);
  return walls;
}

/// meshes: all of the scene's, read before.
std::string hash_of(const Scene& scene, MeshFiles& meshes) {
  TextHash hash;
  hash.add(scene.text);
  const auto add_mesh = [&](const auto& described) {
    if (const auto* mesh = std::get_if<MeshShape>(&described.shape))
      hash.add(meshes.read(*mesh, described.where).bytes);
  };
  for (const FluidBlock& block : scene.blocks) add_mesh(block);
  for (const Wall& wall : scene.walls) add_mesh(wall);
  return hash.text();
}

}  // namespace

PreparedScene prepare(Scene scene) {
  MeshFiles meshes;
  PreparedScene prepared;
  prepared.walls = walls_of(scene, meshes);
  FilledBlocks filled = fill_blocks(scene, prepared.walls, meshes);
  check_emitters(scene, prepared.walls, filled.particles.position);
  prepared.start = std::move(filled.particles);
  prepared.block_area = filled.area;
  prepared.hash = hash_of(scene, meshes);
  prepared.scene = std::move(scene);
  return prepared;
}

}  // namespace kappaflow
