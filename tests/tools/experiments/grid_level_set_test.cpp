#include "tools/experiments/grid_level_set.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/remesh/initial_mesh.h"
#include "tools/experiments/enright_flow.h"

namespace kappaflow {
namespace {

constexpr double kSpacing = 0.02;

bool has_openvdb() {
  try {
    require_openvdb();
    return true;
  } catch (const IoError&) {
    return false;
  }
}

class GridLevelSets : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!has_openvdb()) GTEST_SKIP() << "built without OpenVDB";
  }

  /// A sphere of 0.15 about (0.35, 0.35, 0.35).
  static TriangleMesh start() { return initial_mesh(EnrightField(0), kSpacing, {.tolerance = 1e-8}); }

  /// It after a turn to and fro by an eighth, about the z axis through (0.5, 0.5, 0).
  static TriangleSurface turned(LevelSetScheme scheme) {
    const TriangleMesh sphere = start();
    GridLevelSet set({sphere.position, sphere.triangles}, kSpacing, scheme);
    constexpr int kSteps = 6;  // either way
    for (const double way : {1.0, -1.0})
      for (int n = 0; n < kSteps; ++n)
        set.advect(
            [way](const std::vector<Vec3>& place, std::vector<Vec3>& velocity) {
              for (std::size_t i = 0; i < place.size(); ++i)
                velocity[i] = way * Vec3::UnitZ().cross(place[i] - Vec3(0.5, 0.5, 0));
            },
            0.5, std::numbers::pi / 4 / kSteps);
    return set.surface();
  }
  static double volume(const TriangleSurface& surface) {
    return area_and_volume(surface.vertices, surface.triangles).volume;
  }
  /// Mean distance of the vertices from the sphere, in spacings.
  static double error(const TriangleSurface& surface) {
    double sum = 0;
    for (const Vec3& x : surface.vertices) sum += std::abs((x - Vec3::Constant(0.35)).norm() - 0.15);
    return sum / (static_cast<double>(surface.vertices.size()) * kSpacing);
  }
};

TEST_F(GridLevelSets, AreWhatTheyWereMadeOf) {
  const TriangleMesh sphere = start();
  const GridLevelSet set({sphere.position, sphere.triangles}, kSpacing, LevelSetScheme::weno5);
  const TriangleSurface surface = set.surface();
  EXPECT_NEAR(volume(surface) / area_and_volume(sphere.position, sphere.triangles).volume, 1, 0.02)
      << "and faces outward";
  EXPECT_LT(error(surface), 0.1);
  EXPECT_EQ(mesh_topology(surface.vertices, surface.triangles).genus, 0);
}

// Steps of three cells: plain semi-Lagrangian steps wear the sphere off, the others keep it.
TEST_F(GridLevelSets, TurnASphere) {
  const TriangleMesh sphere = start();
  const double whole = area_and_volume(sphere.position, sphere.triangles).volume;
  for (const auto& [name, scheme] : kLevelSetSchemes) {
    const TriangleSurface surface = turned(scheme);
    const bool wears_off = scheme == LevelSetScheme::semi_lagrangian;
    EXPECT_NEAR(volume(surface) / whole, 1, wears_off ? 0.2 : 0.03) << name;
    EXPECT_LT(error(surface), wears_off ? 0.5 : 0.2) << name;
  }
}

TEST_F(GridLevelSets, SameBitsForAnyNumberOfThreads) {
  for (const auto& [name, scheme] : kLevelSetSchemes) {
    std::vector<TriangleSurface> surfaces;
    for (const std::size_t threads : {1, 2}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      surfaces.push_back(turned(scheme));
    }
    EXPECT_EQ(surfaces[0].vertices, surfaces[1].vertices) << name;
  }
}

}  // namespace
}  // namespace kappaflow
