#include "scenes/mesh_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "scenes/wall_distance.h"
#include "surface/mesh/mesh_measures.h"
#include "tests/scenes/scene_files.h"

namespace kappaflow {
namespace {

const SourcePosition kScene{"scene.toml", 3, 1};

void expect_unit_cube(const std::filesystem::path& file) {
  const TriangleSurface cube = read_closed_mesh(file, kScene).surface;
  EXPECT_EQ(cube.vertices.size(), 8u) << file;
  EXPECT_EQ(cube.triangles.size(), 12u) << file;
  EXPECT_EQ(mesh_topology(cube.vertices, cube.triangles).genus, 0) << file;
  const AreaAndVolume measured = area_and_volume(cube.vertices, cube.triangles);
  EXPECT_NEAR(measured.area, 6, 1e-12) << file;
  EXPECT_NEAR(measured.volume, 1, 1e-12) << file;
}

std::string error_of(const std::filesystem::path& file) {
  try {
    read_closed_mesh(file, kScene);
    return "";
  } catch (const InvalidInput& error) {
    return error.what();
  }
}

/// The cube of cube.ply as a binary file.
std::string binary_ply(bool big_endian) {
  std::string bytes =
      "ply\r\nformat binary_" + std::string(big_endian ? "big" : "little") +
      "_endian 1.0\r\ncomment by a test\r\nelement vertex 8\r\nproperty double x\r\nproperty float y\r\n"
      "property int8 z\r\nproperty uchar red\r\nelement face 6\r\nproperty float quality\r\n"
      "property list uint8 int32 vertex_index\r\nelement end 0\r\nproperty int x\r\nend_header\r\n";
  const auto put = [&](auto value) {
    std::array<char, sizeof value> buffer;
    std::memcpy(buffer.data(), &value, sizeof value);
    if (big_endian) std::reverse(buffer.begin(), buffer.end());
    bytes.append(buffer.data(), buffer.size());
  };
  for (int v = 0; v < 8; ++v) {
    put(double(v & 1));
    put(float(v >> 1 & 1));
    put(std::int8_t(v >> 2));
    put(std::uint8_t(200));
  }
  constexpr int kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& face : kFaces) {
    put(0.5f);
    put(std::uint8_t(4));
    for (const std::int32_t corner : face) put(corner);
  }
  return bytes;
}

TEST(MeshFile, ReadsACubeInEveryFormat) {
  for (const char* name : {"cube.stl", "cube_binary.stl", "cube.obj", "cube.ply", "inside_out.obj"})
    expect_unit_cube(source_file("tests/data/meshes") / name);
  expect_unit_cube(temporary_file("little.ply", binary_ply(false)));
  expect_unit_cube(temporary_file("big.PLY", binary_ply(true)));
}

TEST(MeshFile, ReadsEveryWayToNameAPointInObj) {
  expect_unit_cube(temporary_file(
      "names.obj",
      "# a cube\nmtllib none\no cube\r\nv +0 0 0 1\nv 1e0 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\n"
      "v 1 0 1\nv 0 1 1\nv 1 1 1.0\nvt 0 0\nvn 0 0 1\nf 1/1 3/1 4/1 2/1\nf 5//1 6//1 8//1 7//1\n"
      "f 1/1/1 2/1/1 6/1/1 5/1/1\nf -6 -2 -1 -5\n  f\t1 5 7 3\nf 2 4 8 6"));
}

TEST(MeshFile, CutsPolygonsThatAreNotConvex) {
  // A prism over an L: six corners, one of them reflex, from which a fan at corner 1 would stick out.
  const std::string text =
      "v 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\nv "
      "0 0 1\n"
      "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\nf 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 "
      "12\n";
  const TriangleSurface prism = read_closed_mesh(temporary_file("prism.obj", text), kScene).surface;
  const AreaAndVolume measured = area_and_volume(prism.vertices, prism.triangles);
  EXPECT_NEAR(measured.volume, 3, 1e-12);
  EXPECT_NEAR(measured.area, 2 * 3 + 8, 1e-12);  // a triangle that stuck out would add area
  EXPECT_NEAR(WallDistance(solid_walls(std::vector{prism})).depth({1.5, 1.5, 0.5}), -0.5, 1e-12);
}

TEST(MeshFile, DropsPointsThatNothingUses) {
  const std::string text = read_file(source_file("tests/data/meshes/cube.obj"));
  expect_unit_cube(
      temporary_file("stray.obj", "v 100 100 100\n" + text.substr(0, text.find('f')) +
                                      "f 2 4 5 3\nf 6 7 9 8\nf 2 3 7 6\nf 4 8 9 5\nf 2 6 8 4\nf 3 5 9 7\n"));
}

TEST(MeshFile, ScaleAndTranslationPlaceTheWall) {
  Scene scene;
  add_wall(scene, MeshShape{source_file("tests/data/meshes/cube.stl"), 0.5, Vec3(1, 2, 3)});
  const std::vector<SolidWall> walls = prepare(scene).walls;
  const TriangleSurface& wall = walls[0].surface();
  EXPECT_NEAR(area_and_volume(wall.vertices, wall.triangles).volume, 0.125, 1e-12);
  EXPECT_NEAR(WallDistance(walls).depth({1.25, 2.25, 3.25}), 0.25, 1e-12);
}

TEST(MeshFile, NamesTheLineOfAMistake) {
  EXPECT_EQ(error_of(temporary_file("a.obj", "v 0 0 0\nv 0 zero 0\n")).find("scene.toml:3:1: mesh \""), 0u);
  EXPECT_NE(error_of(temporary_file("a.obj", "v 0 0 0\nv 0 zero 0\n")).find("line 2: found \"zero\""),
            std::string::npos);
  EXPECT_NE(error_of(temporary_file("b.obj", "v 0 0 0\nf 1 1 2\n"))
                .find("line 2: a face names point \"2\"; there are 1"),
            std::string::npos);
  EXPECT_NE(error_of(temporary_file("c.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\n"))
                .find("line 3: more elements than the file has room for"),
            std::string::npos);
}

/// Files cut short anywhere, or with one byte changed, are refused or read; nothing else happens.
TEST(MeshFile, SurvivesDamage) {
  int refused = 0, read = 0;
  const auto try_bytes = [&](const std::string& name, const std::string& bytes) {
    const std::string message = error_of(temporary_file(name, bytes));
    EXPECT_EQ(message.find('\n'), std::string::npos);
    (message.empty() ? read : refused) += 1;
  };
  for (const char* name : {"cube.stl", "cube_binary.stl", "cube.obj", "cube.ply", "binary.ply"}) {
    const bool made_here = std::string_view(name) == "binary.ply";
    const std::string good =
        made_here ? binary_ply(true) : read_file(source_file("tests/data/meshes") / name);
    for (std::size_t size = 0; size < good.size(); size += 3) try_bytes(name, good.substr(0, size));
    for (std::size_t at = 0; at < good.size(); at += 2) {
      std::string bytes = good;
      bytes[at] = static_cast<char>(bytes[at] + 1 + 37 * at);
      try_bytes(name, bytes);
    }
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(read, 100);  // e.g. a changed comment or normal
}

}  // namespace
}  // namespace kappaflow
