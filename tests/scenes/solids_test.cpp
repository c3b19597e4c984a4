// Surfaces of several pieces: what is inside of them.
#include "core/solids.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <numbers>
#include <random>

#include "scenes/mesh_file.h"
#include "scenes/shapes.h"
#include "scenes/wall_distance.h"
#include "tests/joined.h"
#include "tests/scenes/scene_files.h"

namespace kappaflow {
namespace {

using test::joined;

TriangleSurface inward(TriangleSurface surface) {
  for (Triangle& t : surface.triangles) std::swap(t[1], t[2]);
  return surface;
}

TriangleSurface cube(double lower, double edge) {
  return box_surface({Vec3::Constant(lower), Vec3::Constant(lower + edge)});
}

/// As a program would write it.
std::filesystem::path mesh_file(const TriangleSurface& surface) {
  std::string text;
  for (const Vec3& x : surface.vertices) text += fmt::format("v {} {} {}\n", x.x(), x.y(), x.z());
  for (const Triangle& t : surface.triangles)
    text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return temporary_file("pieces.obj", text);
}

std::string refusal(const TriangleSurface& surface) {
  try {
    read_closed_mesh(mesh_file(surface), {"scene.toml", 3, 1});
    return "";
  } catch (const InvalidInput& error) {
    return error.what();
  }
}

/// A surface with flat sides in some direction, each triangle cut into four again and again: much of it lies
/// in one plane but for rounding.
TriangleSurface turned_and_cut(const TriangleSurface& surface, int times) {
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  TriangleSurface cut = surface;
  for (Vec3& x : cut.vertices) x = turn * x;
  for (int level = 0; level < times; ++level) {
    std::map<std::pair<int, int>, int> middle;
    const auto middle_of = [&](int a, int b) {
      const auto [entry, is_new] =
          middle.try_emplace(std::minmax({a, b}), static_cast<int>(cut.vertices.size()));
      if (is_new)
        cut.vertices.emplace_back(0.4 * cut.vertices[std::min(a, b)] + 0.6 * cut.vertices[std::max(a, b)]);
      return entry->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : cut.triangles) {
      const int ab = middle_of(a, b), bc = middle_of(b, c), ca = middle_of(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    cut.triangles = finer;
  }
  return cut;
}

TEST(Solids, FlatSidesDoNotPassThroughThemselves) {
  for (const TriangleSurface& surface :
       {box_surface({Vec3(0, 0, 0), Vec3(1, 0.3, 0.7)}),
        basin_surface({.lower = Vec3(0, 0, 0), .upper = Vec3(1, 1, 1), .thickness = 0.1})})
    EXPECT_EQ(refusal(turned_and_cut(surface, 4)), "");
}

struct PiecesCase {
  const char* name;
  TriangleSurface surface;
  double volume;  // of the union, in cubes of 0.1
};

const TriangleSurface kCube = cube(0, 1);

std::vector<PiecesCase> pieces_cases() {
  return {{"apart", joined({kCube, box_surface({Vec3(2, 0, 0), Vec3(3, 1, 0.5)})}), 1500},
          {"overlapping", joined({kCube, cube(0.5, 1)}), 1875},
          {"three that overlap in one place", joined({kCube, cube(0.5, 1), cube(0.3, 1)}), 2145},
          {"one in another, both facing outward", joined({kCube, cube(0.3, 0.4)}), 1000},
          {"one in another's corner", joined({kCube, cube(0, 0.4)}), 1000},
          {"a cavity", joined({kCube, inward(cube(0.2, 0.6))}), 784},
          {"a cavity with a core", joined({kCube, inward(cube(0.2, 0.6)), cube(0.4, 0.2)}), 792},
          {"a core with a cavity",
           joined({kCube, inward(cube(0.1, 0.8)), cube(0.2, 0.6), inward(cube(0.4, 0.2))}), 696},
          {"a cavity where two solids overlap", joined({kCube, cube(0.2, 1), inward(cube(0.4, 0.4))}),
           1000 + 488},
          {"all inside out", inward(joined({kCube, inward(cube(0.2, 0.6))})), 784}};
}

TEST(Solids, AreFilledAsTheirUnion) {
  for (const auto& [name, surface, volume] : pieces_cases()) {
    const TriangleSurface read = read_closed_mesh(mesh_file(surface), {"scene.toml"}).surface;
    EXPECT_EQ(static_cast<double>(lattice_points(read, 0.1).size()), volume) << name;
  }
}

/// Particles of a block around walls that are at least half a spacing from them.
TEST(Solids, KeepLiquidOutOfTheirUnion) {
  for (const auto& [name, surface, volume] : pieces_cases()) {
    Scene scene;
    scene.fluid.spacing = 0.1;
    add_block(scene, BoxShape{Vec3::Constant(-0.2), Vec3(3.2, 1.7, 1.7)});
    add_wall(scene, MeshShape{mesh_file(surface)});
    EXPECT_EQ(static_cast<double>(prepare(scene).start.position.size()), 34 * 19 * 19 - volume) << name;
  }
}

double winding_number(const TriangleSurface& surface, const Vec3& x) {
  double sum = 0;
  for (const auto& [i, j, k] : surface.triangles) {
    const Vec3 a = surface.vertices[i] - x, b = surface.vertices[j] - x, c = surface.vertices[k] - x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (2 * std::numbers::pi);
}

/// Balls in random places.
TriangleSurface random_balls(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> along(-1, 1);
  std::vector<TriangleSurface> pieces;
  for (int n = 0; n < 8; ++n) {
    const Vec3 center(along(random), along(random), along(random));
    pieces.push_back(sphere_surface({center, 0.5 + 0.2 * along(random)}));
  }
  return joined(pieces);
}

TEST(Solids, AreWhereTheWindingNumberIsPositive) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const TriangleSurface balls = random_balls(seed);
    const std::vector<SolidDistance> solids = solid_distances({&balls, 1});
    EXPECT_EQ(solids.size(), 8u);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> along(-1.2, 1.2);
    int inside = 0, overlap = 0;
    for (int n = 0; n < 500; ++n) {
      const Vec3 x(along(random), along(random), along(random));
      const long winding = std::lround(winding_number(balls, x));
      const double distance = nearest_of_union(solids, x).distance;
      EXPECT_EQ(distance<0, winding> 0) << x.transpose();
      inside += winding > 0;
      overlap += winding > 1;
    }
    EXPECT_GT(inside, 100);
    EXPECT_GT(overlap, 10);
    EXPECT_LT(inside, 400);
  }
}

// What is outside of all pieces is as far as the nearest point of the union's surface; what is inside is at
// least as deep as in any of them.
TEST(Solids, GiveTheDistanceToTheirUnion) {
  const TriangleSurface two = joined({kCube, cube(0.5, 1)});
  const WallDistance walls(solid_walls(std::vector{two}));
  EXPECT_NEAR(walls.depth({1.2, 0.25, 0.25}), -0.2, 1e-12);
  EXPECT_NEAR(walls.depth({1.2, 0.4, 0.6}), -0.1, 1e-12) << "below the second cube";
  EXPECT_NEAR(walls.depth({1.1, 1.1, 1.1}), 0.4, 1e-12);
  EXPECT_GE(walls.depth({0.9, 0.9, 0.9}), 0.4 - 1e-12) << "0.1 from the face of the first that is covered";
}

TEST(Solids, RefusalsNameThePlace) {
  const auto expect_refusal = [](const TriangleSurface& surface, const std::string& text) {
    const std::string found = refusal(surface);
    EXPECT_NE(found.find(text), std::string::npos) << found;
    EXPECT_EQ(found.find("scene.toml:3:1: mesh \""), 0u) << found;
    EXPECT_EQ(found.find('\n'), std::string::npos);
  };
  expect_refusal(joined({kCube, inward(cube(2, 0.5))}),
                 "has a piece at (2, 2, 2) that faces inward and lies in no solid");
  expect_refusal(joined({cube(2, 0.5), inward(kCube)}), "has a piece at (2, 2, 2) that faces inward");
  expect_refusal(joined({kCube, inward(cube(0.2, 0.6)), inward(cube(0.4, 0.2))}),
                 "has a piece at (0.4, 0.4, 0.4) that faces inward");
  const std::string crossing = "has a piece that faces inward and passes through another at about (";
  expect_refusal(joined({kCube, inward(cube(0.5, 0.7))}), crossing);  // through the diagonals of the faces
  expect_refusal(joined({kCube, inward(cube(0.2, 0.6)), cube(0.5, 1)}), crossing);
  TriangleSurface through = kCube;
  through.vertices[0] = Vec3(0.3, 0.4, 1.6);  // the corner at the origin, pushed through the far side
  expect_refusal(through, "has a piece that passes through itself at about (");
}

}  // namespace
}  // namespace kappaflow
