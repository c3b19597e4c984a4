#include "scenes/prepared_scene.h"

#include <utility>
#include <variant>

#include "core/text_hash.h"
#include "scenes/fill.h"
#include "scenes/mesh_file.h"
#include "scenes/rigid_bodies.h"
#include "scenes/shapes.h"
#include "solver/wall_bodies.h"

namespace kappaflow {
namespace {

/// The closed surface of a wall or body, oriented outward.
struct SolidSurface {
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
    walls.emplace_back(std::visit(SolidSurface{meshes, wall.where}, wall.shape), wall.motion);
  return walls;
}

std::vector<RigidBody> bodies_of(const Scene& scene, MeshFiles& meshes) {
  std::vector<RigidBody> bodies;
  for (const SceneBody& body : scene.bodies) {
    SolidWall solid(std::visit(SolidSurface{meshes, body.where}, body.shape));
    const double mass =
        body.density ? *body.density * mass_properties(solid.surface()).volume : body.mass.value_or(0);
    bodies.push_back(
        {std::move(solid), mass, body.velocity, body.angular_velocity, body.friction, body.heat});
  }
  return bodies;
}

std::string hash_of(const Scene& scene, MeshFiles& meshes) {
  TextHash hash;
  hash.add(scene.text);
  const auto add_mesh = [&](const auto& described) {
    if (const auto* mesh = std::get_if<MeshShape>(&described.shape))
      hash.add(meshes.read(*mesh, described.where).bytes);
  };
  for (const FluidBlock& block : scene.blocks) add_mesh(block);
  for (const Wall& wall : scene.walls) add_mesh(wall);
  for (const SceneBody& body : scene.bodies) add_mesh(body);
  return hash.text();
}

PreparedScene with_solids(Scene scene, MeshFiles& meshes) {
  PreparedScene prepared;
  prepared.walls = walls_of(scene, meshes);
  prepared.bodies = bodies_of(scene, meshes);
  check_apart(scene, prepared.walls, prepared.bodies);
  prepared.scene = std::move(scene);
  return prepared;
}

void fill(PreparedScene& prepared, MeshFiles& meshes) {
  const std::vector<SolidWall> solids = all_solids(prepared.walls, prepared.bodies);
  FilledBlocks filled = fill_blocks(prepared.scene, solids, meshes);
  check_emitters(prepared.scene, solids, filled.particles.position);
  prepared.start = std::move(filled.particles);
  prepared.block_area = filled.area;
}

}  // namespace

PreparedScene prepare(Scene scene) {
  MeshFiles meshes;
  PreparedScene prepared = with_solids(std::move(scene), meshes);
  fill(prepared, meshes);
  prepared.hash = hash_of(prepared.scene, meshes);
  return prepared;
}

PreparedScene prepare_without_particles(Scene scene) {
  MeshFiles meshes;
  PreparedScene prepared = with_solids(std::move(scene), meshes);
  prepared.hash = hash_of(prepared.scene, meshes);
  return prepared;
}

void add_particles(PreparedScene& prepared) {
  MeshFiles meshes;
  fill(prepared, meshes);
}

}  // namespace kappaflow
