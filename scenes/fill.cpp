#include "scenes/fill.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/cell_grid.h"
#include "core/machine_memory.h"
#include "scenes/shapes.h"
#include "solver/emitter.h"

namespace kappaflow {
namespace {

#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
constexpr double kMaxParticles = 5e3;  // a fuzzer is to try scenes, not to wait for large ones
#else
constexpr double kMaxParticles = 4e9;  // ids have 32 bits
#endif
constexpr double kBytesPerPoint = 60;  // while blocks are filled
/// Particles start at least this far from a wall, in spacings: half a spacing, less rounding in mesh files.
constexpr double kWallClearance = 0.499;
constexpr double kBlockClearance = 0.9;
/// Farthest coordinate in spacings: single precision then still resolves 1/100 of a spacing.
constexpr double kFarthest = 1e5;

/// What shapes.h takes: a mesh's surface from its file, the other shapes as they are.
const BoxShape& solid_of(const BoxShape& box, const SourcePosition&, MeshFiles&) {
  return box;
}
const SphereShape& solid_of(const SphereShape& sphere, const SourcePosition&, MeshFiles&) {
  return sphere;
}
TriangleSurface solid_of(const MeshShape& mesh, const SourcePosition& where, MeshFiles& meshes) {
  return meshes.surface(mesh, where);
}

/// The lattice of one block. Throws InvalidInput where it is empty, too large or too far out.
template <class Solid>
std::vector<Vec3> checked_lattice(const FluidBlock& block, const Solid& solid, double spacing,
                                  std::size_t particles_before) {
  const double size = lattice_size(solid, spacing);
  if (!(static_cast<double>(particles_before) + size <= kMaxParticles))
    throw InvalidInput(block.where,
                       fmt::format("the liquid would have {:.3g} particles of spacing {} m; allowed: at most "
                                   "{:.3g}, with a larger spacing or smaller blocks",
                                   static_cast<double>(particles_before) + size, spacing, kMaxParticles));
  const double needed = kBytesPerPoint * (static_cast<double>(particles_before) + size);
  if (const double there = static_cast<double>(machine_memory()); needed > there)
    throw InvalidInput(
        block.where,
        fmt::format("the block would have {:.3g} particles of spacing {} m; those of the blocks so far take "
                    "{:.3g} GB of memory at the start alone, there are {:.3g} GB",
                    size, spacing, 1e-9 * needed, 1e-9 * there));
  std::vector<Vec3> points = lattice_points(solid, spacing);
  if (points.empty())
    throw InvalidInput(block.where,
                       fmt::format("the block is too small to hold one particle; allowed: blocks larger than "
                                   "the spacing, {} m",
                                   spacing));
  double farthest = 0;
  for (const Vec3& x : points) farthest = std::max(farthest, x.lpNorm<Eigen::Infinity>());
  if (farthest > kFarthest * spacing)
    throw InvalidInput(
        block.where, fmt::format("the block reaches {:.6g} m from the origin along an axis; allowed: at most "
                                 "{:.0f} spacings, {:.6g} m",
                                 farthest, kFarthest, kFarthest * spacing));
  return points;
}

/// 1 for every point that may become a particle.
std::vector<char> free_points(std::span<const Vec3> points, std::span<const SolidWall> solids,
                              std::span<const Vec3> taken, double spacing) {
  CellGrid grid;
  const double clearance = kBlockClearance * spacing;
  grid.build(taken, spacing);
  std::vector<char> is_free(points.size());
  parallel_for(points.size(), [&](std::size_t i) {
    const Vec3& x = points[i];
    bool crowded = nearest_of_walls(solids, x).distance < kWallClearance * spacing;
    grid.ranges_near(x, clearance, [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t k = begin; k < end; ++k)
        crowded = crowded || (taken[grid.order()[k]] - x).squaredNorm() < clearance * clearance;
    });
    is_free[i] = !crowded;
  });
  return is_free;
}

/// Appends the particles of a block; returns whether there were any.
bool add_free_points(std::span<const Vec3> points, const FluidBlock& block, int number,
                     const FluidOptions& fluid, std::span<const SolidWall> solids,
                     FluidParticlesAtStart& particles) {
  const std::vector<char> is_free = free_points(points, solids, particles.position, fluid.spacing);
  const std::size_t before = particles.position.size();
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_free[i]) particles.position.push_back(points[i]);
  particles.velocity.resize(particles.position.size(), block.velocity);
  particles.fluid.resize(particles.position.size(), block.fluid);
  particles.source.resize(particles.position.size(), number);
  if (fluid.heat)
    particles.temperature.resize(particles.position.size(),
                                 block.temperature.value_or(fluid.heat->temperature));
  return particles.position.size() > before;
}

/// Throws InvalidInput where a particle in the nozzle would be in a wall or in the liquid of a block, or too
/// far out.
void check_nozzle(const Scene& scene, std::size_t index, std::span<const SolidWall> solids,
                  std::span<const Vec3> blocks) {
  const Emitter& emitter = scene.fluid.emitters[index];
  const SourcePosition& where = scene.emitters_where[index];
  const double spacing = scene.fluid.spacing;
  const std::vector<Vec3> layer = emitter_layer(emitter, spacing);
  const RigidPose pose = emitter.motion.pose(emitter.start);
  std::vector<Vec3> points;
  for (const double behind : {0.0, 0.5, 1.5, kNozzleLength})
    for (const Vec3& x : layer)
      points.push_back(pose * (emitter.position + x - behind * spacing * emitter.direction.normalized()));
  const std::vector<char> is_free =
      free_points(points, solids, emitter.start > 0 ? std::span<const Vec3>() : blocks, spacing);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!is_free[i])
      throw InvalidInput(
          where,
          fmt::format(
              "the nozzle has a particle at ({:.4g}, {:.4g}, {:.4g}) m, in or too close to a wall, a body or "
              "the liquid of a block; allowed: a mouth with {} spacings, {:.4g} m, free behind it",
              points[i].x(), points[i].y(), points[i].z(), kNozzleLength, kNozzleLength * spacing));
    if (points[i].lpNorm<Eigen::Infinity>() > kFarthest * spacing)
      throw InvalidInput(
          where, fmt::format("the mouth is further from the origin than {:.0f} spacings, {:.6g} m", kFarthest,
                             kFarthest * spacing));
  }
}

/// Throws InvalidInput where the emitters make too many particles by the end.
void check_emitted(const Scene& scene, std::size_t in_blocks) {
  double total = static_cast<double>(in_blocks);
  for (std::size_t e = 0; e < scene.fluid.emitters.size(); ++e) {
    total += emitted_particles(scene.fluid.emitters[e], scene);
    if (total > kMaxParticles && scene.fluid.outflows.empty())
      throw InvalidInput(scene.emitters_where[e],
                         fmt::format("the liquid would have {:.3g} particles by the end; allowed: at most "
                                     "{:.3g}, with a larger spacing, a smaller mouth or a particle_limit",
                                     total, kMaxParticles));
  }
}

}  // namespace

double emitted_particles(const Emitter& emitter, const Scene& scene) {
  const std::size_t layer = emitter_layer(emitter, scene.fluid.spacing).size();
  return static_cast<double>(layer) * emitted_layers(emitter, scene.fluid.spacing, layer, scene.duration);
}

FilledBlocks fill_blocks(const Scene& scene, std::span<const SolidWall> solids, MeshFiles& meshes) {
  const double spacing = scene.fluid.spacing;
  FilledBlocks filled;
  for (std::size_t b = 0; b < scene.blocks.size(); ++b) {
    const FluidBlock& block = scene.blocks[b];
    const auto lattice_of = [&](const auto& shape) {
      const auto& solid = solid_of(shape, block.where, meshes);
      filled.area += surface_area(solid);
      return checked_lattice(block, solid, spacing, filled.particles.position.size());
    };
    const std::vector<Vec3> points = std::visit(lattice_of, block.shape);
    if (!add_free_points(points, block, static_cast<int>(b), scene.fluid, solids, filled.particles))
      throw InvalidInput(
          block.where,
          "no particle of the block is free: all lie in a wall or body, within half a spacing of one, or "
          "in an earlier block; allowed: a block with room for one particle");
  }
  return filled;
}

void check_emitters(const Scene& scene, std::span<const SolidWall> solids, std::span<const Vec3> filled) {
  for (std::size_t e = 0; e < scene.fluid.emitters.size(); ++e) check_nozzle(scene, e, solids, filled);
  check_emitted(scene, filled.size());
}

}  // namespace kappaflow
