// Meshes millions of metres from the origin, as in maps' coordinates, in every format.
#include <vtkCell.h>
#include <vtkPointData.h>
#include <vtk_jsoncpp.h>

#include <cstring>

#include "core/errors.h"
#include "scenes/mesh_file.h"
#include "scenes/shapes.h"
#include "surface/mesh/mesh_measures.h"
#include "tests/tools/scratch.h"
#include "tests/tools/sequence_files.h"
#include "tests/vtk_reader.h"
#include "tools/io/glb.h"
#include "tools/io/vtp_files.h"
#include "tools/runs/track.h"

namespace kappaflow {
namespace {

const Vec3 kFar(5e6, 1e7, -2e6);

double area(const TriangleSurface& surface) {
  return area_and_volume(surface.vertices, surface.triangles).area;
}

template <class Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

/// The triangles of a .glb file as they lie in the scene.
TriangleSurface read_glb(const std::string& bytes) {
  const auto json_size = number_at<std::uint32_t>(bytes, 12);
  Json::Value json;
  EXPECT_TRUE(Json::Reader().parse(bytes.substr(20, json_size), json));
  Vec3 translation = Vec3::Zero();
  const Json::Value& node = json["nodes"][0];
  for (int a = 0; a < 3; ++a)
    if (node.isMember("translation")) translation[a] = node["translation"][a].asDouble();
  const auto begin_of = [&](int accessor) {
    return 20 + json_size + 8 + json["bufferViews"][accessor]["byteOffset"].asUInt();
  };
  TriangleSurface surface;
  for (unsigned v = 0; v < json["accessors"][0]["count"].asUInt(); ++v) {
    Vec3 x;
    for (unsigned a = 0; a < 3; ++a)
      x[a] = static_cast<double>(number_at<float>(bytes, begin_of(0) + 4 * (3 * v + a)));
    for (int a = 0; a < 3; ++a) {
      EXPECT_GE(static_cast<float>(x[a]), json["accessors"][0]["min"][a].asFloat());
      EXPECT_LE(static_cast<float>(x[a]), json["accessors"][0]["max"][a].asFloat());
    }
    surface.vertices.emplace_back(translation + x);
  }
  for (unsigned t = 0; t < json["accessors"][4]["count"].asUInt() / 3; ++t) {
    Triangle triangle;
    for (unsigned a = 0; a < 3; ++a) triangle[a] = number_at<int>(bytes, begin_of(4) + 4 * (3 * t + a));
    surface.triangles.push_back(triangle);
  }
  return surface;
}

class FarMesh : public Scratch {
 protected:
  TriangleSurface read(MeshFormat format, const std::string& bytes) const {
    if (format == MeshFormat::glb) return read_glb(bytes);
    return read_closed_mesh(file(format == MeshFormat::obj ? "a.obj" : "a.ply", bytes), {"test"}).surface;
  }
};

TEST_F(FarMesh, IsReadBackAsItIs) {
  for (const double scale : {0.0, 1e-3, 0.1, 1.0}) {  // of the distance from the origin
    const TriangleSurface ball = sphere_surface({scale * kFar, 0.5});
    const std::vector<Vec3> normal(ball.vertices.size(), Vec3::UnitX());
    const std::vector<Vec2> texture(ball.vertices.size(), Vec2::Zero());
    const std::vector<Rgb> colour(ball.vertices.size(), Rgb{1, 2, 3});
    for (const auto& [name, format] : kMeshFormats) {
      if (format == MeshFormat::usd) continue;  // usd_test.cpp
      const TriangleSurface found =
          read(format, mesh_bytes(format, {ball.vertices, normal, texture, colour, ball.triangles}));
      ASSERT_EQ(found.vertices.size(), ball.vertices.size()) << name << " at " << scale;
      ASSERT_EQ(found.triangles.size(), ball.triangles.size());
      EXPECT_NEAR(area(found), area(ball), 1e-6 * area(ball)) << name << " at " << scale;
      for (std::size_t t = 0; t < ball.triangles.size(); ++t)
        for (int c = 0; c < 3; ++c)
          EXPECT_LT((found.vertices[found.triangles[t][c]] - ball.vertices[ball.triangles[t][c]]).norm(),
                    1e-6);
    }
  }
}

/// A cube of particles in the middle of nowhere, at rest and in motion.
TEST_F(FarMesh, IsTrackedAsNearTheOrigin) {
  std::array<std::vector<double>, 2> areas;
  for (const bool far : {false, true}) {
    for (int frame = 0; frame < 3; ++frame) {
      std::string text = "x,y,z,vx,vy,vz\n";
      for (const Vec3& x : jittered_block()) {
        const Vec3 at = x + (far ? kFar : Vec3::Zero()) + 0.04 * frame * kBodyMotion.velocity;
        text += fmt::format("{},{},{},0.5,0.25,-0.125\n", at.x(), at.y(), at.z());
      }
      file(fmt::format("{}_{}.csv", far ? "far" : "near", frame), text);
    }
    TrackOptions options;
    options.inputs = {(folder / (far ? "far_*.csv" : "near_*.csv")).string()};
    options.folder = folder / (far ? "out_far" : "out_near");
    options.methods = {"regional"};
    options.frames_per_second = 25;
    options.formats = {MeshFormat::obj, MeshFormat::ply, MeshFormat::glb};
    options.force = options.quiet = true;
    track(options);
    const std::filesystem::path surfaces = options.folder / "surface-regional";
    for (int frame = 0; frame < 3; ++frame) {
      const std::string stem = (surfaces / fmt::format("surface_{:04}", frame)).string();
      TriangleSurface vtp;
      const auto data = read_vtp(stem + ".vtp");
      for (vtkIdType v = 0; v < data->GetNumberOfPoints(); ++v) vtp.vertices.emplace_back(data->GetPoint(v));
      for (vtkIdType t = 0; t < data->GetNumberOfPolys(); ++t) {
        vtkCell& cell = *data->GetCell(t);
        vtp.triangles.push_back({static_cast<int>(cell.GetPointId(0)), static_cast<int>(cell.GetPointId(1)),
                                 static_cast<int>(cell.GetPointId(2))});
      }
      areas[far].push_back(area(vtp));
      EXPECT_NEAR(area(read_closed_mesh(stem + ".obj", {"test"}).surface), area(vtp), 1e-6 * area(vtp))
          << far;
      EXPECT_NEAR(area(read_closed_mesh(stem + ".ply", {"test"}).surface), area(vtp), 1e-6 * area(vtp))
          << far;
      EXPECT_NEAR(area(read_glb(bytes_of(stem + ".glb"))), area(vtp), 1e-6 * area(vtp)) << far;
    }
  }
  for (std::size_t frame = 0; frame < 3; ++frame)
    EXPECT_NEAR(areas[true][frame], areas[false][frame], 1e-4 * areas[false][frame]) << frame;
}

// The lengths of a .glb file have 32 bits: too large a mesh is refused before anything is made of it.
TEST(GlbSize, IsBelowFourGigabytes) {
  const std::size_t most = std::size_t{1} << 32;
  EXPECT_NO_THROW(check_glb_size(1000, 2000));
  EXPECT_NO_THROW(check_glb_size(67100000, 134200000));  // 40 bytes a vertex, 12 a triangle: 4.2944e9
  for (const auto& [vertices, triangles] : {std::pair<std::size_t, std::size_t>{67120000, 134240000},
                                            {most / 40, 0},
                                            {0, most / 12},
                                            {most, most}})
    try {
      check_glb_size(vertices, triangles);
      ADD_FAILURE() << vertices << " vertices, " << triangles << " triangles";
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(".glb file holds at most 4 GiB"), std::string::npos);
    }
}

// What check_glb_size() counts with.
TEST(GlbSize, IsAsCounted) {
  const TriangleSurface ball = sphere_surface({kFar, 0.5});
  const std::size_t n = ball.vertices.size(), arrays = 40 * n + 12 * ball.triangles.size();
  const std::vector<Vec3> normal(n, Vec3::UnitX());
  const std::vector<Vec2> texture(n, Vec2::Zero());
  const std::vector<Rgb> colour(n, Rgb{1, 2, 3});
  const std::string bytes = glb_bytes({ball.vertices, normal, texture, colour, ball.triangles});
  EXPECT_GT(bytes.size(), arrays);
  EXPECT_LT(bytes.size(), arrays + 4096);
}

}  // namespace
}  // namespace kappaflow
