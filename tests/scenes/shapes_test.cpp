#include "scenes/shapes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <set>

#include "scenes/wall_distance.h"
#include "surface/mesh/mesh_measures.h"
#include "tests/scenes/scene_files.h"

namespace kappaflow {
namespace {

StairsShape example_stairs(int steps) {
  return {.steps = steps,
          .rise = 0.2,
          .run = 0.5,
          .landing = 1.5,
          .floor = 2,
          .width = 1.6,
          .thickness = 0.3,
          .origin = Vec3(1.5, -1, 2)};
}

double analytic_volume(const StairsShape& s) {
  const double length = s.landing + (s.steps - 1) * s.run + s.floor;
  double section = s.thickness * length + s.landing * s.steps * s.rise;
  for (int tread = 1; tread < s.steps; ++tread) section += s.run * (s.steps - tread) * s.rise;
  return section * s.width;
}

double analytic_area(const StairsShape& s) {
  const double length = s.landing + (s.steps - 1) * s.run + s.floor;
  const double perimeter = 2 * (length + s.thickness + s.steps * s.rise);
  return perimeter * s.width + 2 * analytic_volume(s) / s.width;
}

TEST(BoxSurface, IsClosedWithTheBoxesVolumeAndArea) {
  const TriangleSurface box = box_surface({Vec3(-1, 0, 2), Vec3(1, 3, 2.5)});
  const MeshTopology topology = mesh_topology(box.vertices, box.triangles);
  EXPECT_EQ(topology.components, 1);
  EXPECT_EQ(topology.genus, 0);
  EXPECT_EQ(box.vertices.size(), 8u);
  EXPECT_EQ(box.triangles.size(), 12u);
  const AreaAndVolume measured = area_and_volume(box.vertices, box.triangles);
  EXPECT_NEAR(measured.volume, 3, 1e-14);
  EXPECT_NEAR(measured.area, 2 * (6 + 1.5 + 1), 1e-14);
}

TEST(SphereAndCylinder, AreClosedWithNearlyTheirVolume) {
  const auto measured = [](const TriangleSurface& s) {
    EXPECT_EQ(mesh_topology(s.vertices, s.triangles).components, 1);  // throws unless closed and oriented
    EXPECT_EQ(mesh_topology(s.vertices, s.triangles).genus, 0);
    return area_and_volume(s.vertices, s.triangles).volume;
  };
  const TriangleSurface sphere = sphere_surface({Vec3(1, -2, 0.5), 0.7});
  EXPECT_NEAR(measured(sphere), 4.0 / 3 * M_PI * std::pow(0.7, 3), 0.01);
  for (const Vec3& x : sphere.vertices) EXPECT_NEAR((x - Vec3(1, -2, 0.5)).norm(), 0.7, 1e-14);
  const TriangleSurface cylinder = cylinder_surface({Vec3(1, 1, 1), Vec3(3, 2, -1), 0.4});
  EXPECT_NEAR(measured(cylinder), M_PI * 0.4 * 0.4 * 3, 0.01);
  for (const Vec3& x : cylinder.vertices) {
    const Vec3 axis = Vec3(2, 1, -2) / 3;
    const double along = (x - Vec3(1, 1, 1)).dot(axis);
    EXPECT_TRUE(std::abs(along) < 1e-14 || std::abs(along - 3) < 1e-14);
    EXPECT_LT((x - Vec3(1, 1, 1)).cross(axis).norm(), 0.4 + 1e-14);
  }
}

TEST(Basin, IsOneClosedSurfaceWithTheVolumeOfItsWallsAndIsOpenAbove) {
  const TriangleSurface basin = basin_surface({Vec3(-1, 0, 2), Vec3(1, 3, 2.5), 0.25});
  EXPECT_EQ(mesh_topology(basin.vertices, basin.triangles).components, 1);
  EXPECT_EQ(mesh_topology(basin.vertices, basin.triangles).genus, 0);
  EXPECT_NEAR(area_and_volume(basin.vertices, basin.triangles).volume, 2.5 * 3.25 * 1 - 3, 1e-14);
  const WallDistance distance(solid_walls(std::vector{basin}));
  EXPECT_NEAR(distance.depth(Vec3(0, 2, 2.25)), -0.25, 1e-14);
  EXPECT_NEAR(distance.depth(Vec3(0, 4, 2.25)), -std::hypot(1.0, 0.25), 1e-14);
  EXPECT_NEAR(distance.depth(Vec3(0, -0.1, 2.25)), 0.1, 1e-14);
}

class Stairs : public testing::TestWithParam<int> {};

TEST_P(Stairs, AreOneClosedSurfaceWithAnalyticVolumeAndArea) {
  const StairsShape shape = example_stairs(GetParam());
  const TriangleSurface stairs = stairs_surface(shape);
  const MeshTopology topology =
      mesh_topology(stairs.vertices, stairs.triangles);  // throws unless closed and oriented
  EXPECT_EQ(topology.components, 1);
  EXPECT_EQ(topology.genus, 0);
  const AreaAndVolume measured = area_and_volume(stairs.vertices, stairs.triangles);
  EXPECT_NEAR(measured.volume, analytic_volume(shape), 1e-12);
  EXPECT_NEAR(measured.area, analytic_area(shape), 1e-12);
}

TEST_P(Stairs, HaveNoVertexInsideAnEdge) {
  const TriangleSurface stairs = stairs_surface(example_stairs(GetParam()));
  for (const Triangle& t : stairs.triangles)
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = stairs.vertices[t[k]], &b = stairs.vertices[t[(k + 1) % 3]];
      for (const Vec3& x : stairs.vertices) {
        const double detour = (x - a).norm() + (b - x).norm() - (b - a).norm();
        EXPECT_TRUE(x == a || x == b || detour > 1e-9);
      }
    }
}

TEST_P(Stairs, HaveTreadsWhereTheyShouldBe) {
  const StairsShape shape = example_stairs(GetParam());
  const WallDistance walls(solid_walls(std::vector{stairs_surface(shape)}));
  const double top = shape.origin.y() + shape.steps * shape.rise;
  const double edge = shape.origin.x() - (shape.steps - 1) * shape.run;
  EXPECT_NEAR(walls.depth({edge - 0.7, top + 0.05, 2}), -0.05, 1e-12);  // over the landing
  EXPECT_NEAR(walls.depth({edge - 0.7, top - 0.05, 2}), 0.05, 1e-12);
  for (int riser = 1; riser < shape.steps; ++riser)
    EXPECT_NEAR(walls.depth({edge + (riser - 0.5) * shape.run, top - riser * shape.rise + 0.05, 2}), -0.05,
                1e-12);
  EXPECT_NEAR(walls.depth({shape.origin.x() + 1, shape.origin.y() + 0.05, 2}), -0.05,
              1e-12);  // over the floor
  EXPECT_NEAR(walls.depth({shape.origin.x() + 1, shape.origin.y() - 0.1, 2}), 0.1, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Steps, Stairs, testing::Values(1, 2, 5, 40));

TEST(LatticePoints, FillABoxHalfASpacingInsideItsFaces) {
  const BoxShape box{Vec3(-0.3, 1, 0), Vec3(0.7, 1.2, 0.3)};
  const std::vector<Vec3> points = lattice_points(box, 0.1);
  EXPECT_EQ(points.size(), 10u * 2 * 3);
  EXPECT_EQ(lattice_size(box, 0.1), 60);
  EXPECT_TRUE(points.front().isApprox(Vec3(-0.25, 1.05, 0.05), 1e-14));
  EXPECT_TRUE(points.back().isApprox(Vec3(0.65, 1.15, 0.25), 1e-14));
  EXPECT_EQ(lattice_points({Vec3(0, 0, 0), Vec3(0.29, 0.11, 0.1)}, 0.1).size(), 2u);  // whole cells alone
}

TEST(LatticePoints, FillASphereSymmetricallyWithItsVolume) {
  const SphereShape sphere{Vec3(1, -2, 3), 0.5};
  for (const double spacing : {0.3, 0.1, 0.04}) {
    const std::vector<Vec3> points = lattice_points(sphere, spacing);
    Vec3 sum = Vec3::Zero();
    for (const Vec3& x : points) {
      EXPECT_LE((x - sphere.center).norm(), sphere.radius * (1 + 1e-5));
      sum += x - sphere.center;
    }
    EXPECT_LT(sum.norm(), 1e-12 * static_cast<double>(points.size()));
    EXPECT_LE(static_cast<double>(points.size()), lattice_size(sphere, spacing));
    // The lattice points in a ball are as many as its volume in cells, up to its surface in cells (Gauss).
    const double cells = 4. / 3 * M_PI * std::pow(sphere.radius / spacing, 3);
    if (spacing <= 0.1) {
      EXPECT_NEAR(static_cast<double>(points.size()), cells, 2 * std::pow(sphere.radius / spacing, 2));
    }
  }
}

TEST(LatticePoints, FillAMeshAsTheShapeThatItIs) {
  const BoxShape box{Vec3(-0.3, 1, 0), Vec3(0.7, 1.2, 0.3)};
  EXPECT_EQ(lattice_points(box_surface(box), 0.1), lattice_points(box, 0.1));
  EXPECT_EQ(lattice_size(box_surface(box), 0.1), 60);
  const StairsShape stairs = example_stairs(3);  // not convex
  const double cells = analytic_volume(stairs) / std::pow(0.05, 3);
  const std::vector<Vec3> points = lattice_points(stairs_surface(stairs), 0.05);
  EXPECT_NEAR(static_cast<double>(points.size()), cells, 1e-9 * cells);
  EXPECT_LE(static_cast<double>(points.size()), lattice_size(stairs_surface(stairs), 0.05));
  const WallDistance inside(solid_walls(std::vector{stairs_surface(stairs)}));
  for (const Vec3& x : points) EXPECT_GT(inside.depth(x), 0);
}

TEST(FillBlocks, LeavesOutWhatIsInOrNearAWall) {
  Scene scene;
  scene.fluid.spacing = 0.1;
  add_block(scene, BoxShape{Vec3(0, 0, 0), Vec3(1, 1, 1)}, Vec3(1, 2, 3));
  EXPECT_EQ(prepare(scene).start.position.size(), 1000u);
  add_wall(scene, BoxShape{Vec3(-1, -1, -1), Vec3(2, 0, 2)});  // touches: stays whole
  EXPECT_EQ(prepare(scene).start.position.size(), 1000u);
  add_wall(scene, BoxShape{Vec3(-1, 0.47, -1), Vec3(2, 2, 2)});  // layers at 0.45 and above are too near
  const FluidParticlesAtStart start = prepare(scene).start;
  EXPECT_EQ(start.position.size(), 400u);
  for (const Vec3& x : start.position) EXPECT_LT(x.y(), 0.36);
  for (const Vec3& v : start.velocity) EXPECT_EQ(v, Vec3(1, 2, 3));
  EXPECT_EQ(start.velocity.size(), start.position.size());
}

TEST(FillBlocks, LeavesOutWhatAnEarlierBlockFilled) {
  Scene scene;
  scene.fluid.spacing = 0.1;
  add_block(scene, BoxShape{Vec3(0, 0, 0), Vec3(1, 1, 1)}, Vec3(1, 0, 0));
  add_block(scene, BoxShape{Vec3(0.5, 0, 0), Vec3(1.5, 1, 1)}, Vec3(0, 1, 0));  // half of it is filled
  add_block(scene, SphereShape{Vec3(0.77, 0.52, 0.49), 0.9}, Vec3(0, 0, 1));    // on another lattice
  const FluidParticlesAtStart start = prepare(scene).start;
  ASSERT_GT(start.position.size(), 1500u);
  EXPECT_EQ(start.velocity[999], Vec3(1, 0, 0));
  EXPECT_EQ(start.velocity[1000], Vec3(0, 1, 0));
  EXPECT_EQ(start.velocity[1499], Vec3(0, 1, 0));
  EXPECT_EQ(start.velocity[1500], Vec3(0, 0, 1));
  double nearest = 1;
  for (std::size_t i = 0; i < start.position.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      nearest = std::min(nearest, (start.position[i] - start.position[j]).norm());
  EXPECT_GE(nearest, 0.09);
  EXPECT_LT(nearest, 0.0999);  // the rule is 0.9 spacings, not 1
}

TEST(FillBlocks, ParticlesCarryTheFluidAndTheNumberOfTheirBlock) {
  Scene scene;
  scene.fluid.spacing = 0.1;
  add_block(scene, BoxShape{Vec3(0, 0, 0), Vec3(1, 1, 1)});
  add_block(scene, SphereShape{Vec3(3, 0, 0), 0.3});
  scene.blocks.back().fluid = 1;
  add_block(scene, SphereShape{Vec3(5, 0, 0), 0.3});
  const FluidParticlesAtStart start = prepare(scene).start;
  ASSERT_EQ(start.fluid.size(), start.position.size());
  ASSERT_EQ(start.source.size(), start.position.size());
  for (std::size_t i = 0; i < start.fluid.size(); ++i) {
    const int block = (start.position[i].x() > 2) + (start.position[i].x() > 4);
    EXPECT_EQ(start.fluid[i], block == 1);
    EXPECT_EQ(start.source[i], block);
  }
}

TEST(ShippedScenes, LoadWithRoundNumbersOfParticles) {
  const std::filesystem::path folder = std::filesystem::path(KAPPAFLOW_SOURCE_DIR) / "scenes";
  std::set<std::string> seen;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".toml") continue;
    const PreparedScene prepared = prepare(load_scene(entry.path()));
    const Scene& scene = prepared.scene;
    seen.insert(entry.path().filename().string());
    if (scene.blocks.empty()) continue;  // emitters alone
    double volume = 0;                   // of the blocks: nothing of them may be lost to walls
    double tolerance = 1e-9;
    for (const FluidBlock& block : scene.blocks)
      if (const auto* box = std::get_if<BoxShape>(&block.shape)) {
        volume += (box->upper - box->lower).prod();
      } else {
        volume += 4.0 / 3 * M_PI * std::pow(std::get<SphereShape>(block.shape).radius, 3);
        tolerance = 0.01 * volume;  // a lattice does not fill a ball evenly
      }
    const FluidParticlesAtStart& start = prepared.start;
    EXPECT_NEAR(static_cast<double>(start.position.size()) * std::pow(scene.fluid.spacing, 3), volume,
                tolerance)
        << entry.path();
    const WallDistance walls(prepared.walls);
    for (const Vec3& x : start.position)
      ASSERT_LE(walls.depth(x), -0.499 * scene.fluid.spacing) << entry.path();
  }
  EXPECT_TRUE(seen.contains("staircase.toml"));
  EXPECT_TRUE(seen.contains("staircase-small.toml"));
  EXPECT_TRUE(seen.contains("staircase-large.toml"));
  EXPECT_TRUE(seen.contains("honey.toml"));
}

TEST(ShippedScenes, HaveTheStatedSizes) {
  const std::filesystem::path folder = std::filesystem::path(KAPPAFLOW_SOURCE_DIR) / "scenes";
  EXPECT_NEAR(static_cast<double>(prepare(load_scene(folder / "staircase.toml")).start.position.size()), 1e4,
              5e3);
  EXPECT_NEAR(static_cast<double>(prepare(load_scene(folder / "staircase-small.toml")).start.position.size()),
              1e3, 5e2);
  EXPECT_GE(prepare(load_scene(folder / "staircase-large.toml")).start.position.size(), 100000u);
}

}  // namespace
}  // namespace kappaflow
