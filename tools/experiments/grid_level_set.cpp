#include "tools/experiments/grid_level_set.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetAdvect.h>
#include <openvdb/tools/LevelSetTracker.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/Morphology.h>
#include <openvdb/tools/VelocityFields.h>
#include <openvdb/tools/VolumeAdvect.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <openvdb/tree/LeafManager.h>

#include <cmath>
#include <utility>
#include <vector>

namespace kappaflow {
namespace {

using openvdb::FloatGrid;
using openvdb::Vec3SGrid;
using VelocityField = openvdb::tools::DiscreteField<Vec3SGrid>;

constexpr int kMargin = 3;  // [cells] that the schemes read beyond those that they come from

/// The velocities in the band and as far around as the surface moves in dt.
Vec3SGrid::Ptr sampled(const GridLevelSet::Velocities& velocities, const FloatGrid& values, int cells) {
  const auto grid = Vec3SGrid::create();
  grid->setTransform(values.transform().copy());
  grid->setTree(
      std::make_shared<openvdb::Vec3STree>(values.tree(), openvdb::Vec3s(0), openvdb::TopologyCopy()));
  openvdb::tools::dilateActiveValues(grid->tree(), cells + kMargin, openvdb::tools::NN_FACE,
                                     openvdb::tools::EXPAND_TILES);
  std::vector<Vec3> place;
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    const openvdb::Vec3d x = grid->indexToWorld(value.getCoord());
    place.emplace_back(x.x(), x.y(), x.z());
  }
  std::vector<Vec3> velocity(place.size());
  velocities(place, velocity);
  std::size_t next = 0;
  for (auto value = grid->beginValueOn(); value; ++value, ++next)
    value.setValue(openvdb::Vec3d(velocity[next].x(), velocity[next].y(), velocity[next].z()));
  return grid;
}

/// OpenVDB's tracker and advection take the same schemes by functions of other names.
void advect_by_weno5(FloatGrid& values, const Vec3SGrid& velocity, double dt) {
  openvdb::tools::LevelSetAdvection<FloatGrid, VelocityField> advection(values, VelocityField(velocity));
  advection.setSpatialScheme(openvdb::math::HJWENO5_BIAS);
  advection.setTemporalScheme(openvdb::math::TVD_RK3);
  advection.setTrackerSpatialScheme(openvdb::math::HJWENO5_BIAS);
  advection.setTrackerTemporalScheme(openvdb::math::TVD_RK3);
  advection.advect(0, static_cast<float>(dt));
}

FloatGrid::Ptr advected_back(const FloatGrid& values, const Vec3SGrid& velocity, LevelSetScheme scheme,
                             double dt) {
  using openvdb::tools::Scheme::SemiLagrangian;
  openvdb::tools::VolumeAdvection<Vec3SGrid> advection(velocity);
  advection.setIntegrator(scheme == LevelSetScheme::maccormack ? SemiLagrangian::MAC
                          : scheme == LevelSetScheme::bfecc    ? SemiLagrangian::BFECC
                                                               : SemiLagrangian::MID);
  advection.setLimiter(openvdb::tools::Scheme::CLAMP);
  FloatGrid::Ptr moved = advection.advect<FloatGrid, openvdb::tools::BoxSampler>(values, dt);
  openvdb::tools::LevelSetTracker<FloatGrid> tracker(*moved);
  tracker.setSpatialScheme(openvdb::math::HJWENO5_BIAS);
  tracker.setTemporalScheme(openvdb::math::TVD_RK3);
  tracker.track();
  return moved;
}

}  // namespace

struct GridLevelSet::Grid {
  FloatGrid::Ptr values;
  LevelSetScheme scheme;
};

void require_openvdb() {}

GridLevelSet::GridLevelSet(const TriangleSurface& surface, double spacing, LevelSetScheme scheme)
    : grid_(std::make_unique<Grid>()) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const Vec3& x : surface.vertices) points.emplace_back(x.x(), x.y(), x.z());
  for (const auto& [a, b, c] : surface.triangles) triangles.emplace_back(a, b, c);
  const auto transform = openvdb::math::Transform::createLinearTransform(spacing);
  grid_->values = openvdb::tools::meshToLevelSet<FloatGrid>(*transform, points, triangles);
  grid_->scheme = scheme;
}

GridLevelSet::GridLevelSet(GridLevelSet&& other) noexcept = default;
GridLevelSet::~GridLevelSet() = default;

void GridLevelSet::advect(const Velocities& velocities, double fastest, double dt) {
  FloatGrid::Ptr& values = grid_->values;
  if (values->activeVoxelCount() == 0) return;
  const int cells = static_cast<int>(std::ceil(fastest * dt / values->voxelSize()[0]));
  const Vec3SGrid::Ptr velocity = sampled(velocities, *values, cells);
  if (grid_->scheme == LevelSetScheme::weno5)
    advect_by_weno5(*values, *velocity, dt);
  else
    values = advected_back(*values, *velocity, grid_->scheme, dt);
}

TriangleSurface GridLevelSet::surface() const {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid_->values, points, quads);
  TriangleSurface result;
  for (const openvdb::Vec3s& x : points) result.vertices.emplace_back(x.x(), x.y(), x.z());
  for (const openvdb::Vec4I& quad : quads) {
    const auto corner = [&](int c) { return static_cast<int>(quad[c]); };
    result.triangles.push_back({corner(0), corner(2), corner(1)});
    result.triangles.push_back({corner(0), corner(3), corner(2)});
  }
  return result;
}

}  // namespace kappaflow
