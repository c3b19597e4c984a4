// USD text files without a USD library: what stands in them, and that it is what was to be written.
#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "core/body_motion.h"
#include "scenes/shapes.h"
#include "tests/tools/scratch.h"
#include "tools/io/exported_arrays.h"
#include "tools/io/usd_file.h"
#include "tools/io/usd_walls.h"
#include "tools/io/vtp_files.h"

namespace kappaflow {
namespace {

constexpr int kFrame = 7;

/// The numbers of an attribute at kFrame, brackets and commas aside; empty where there are none.
std::vector<double> numbers_of(const std::string& text, const std::string& attribute) {
  const std::size_t line = text.find(attribute + ".timeSamples = {\n");
  if (line == std::string::npos) return {};
  const std::string before = fmt::format("{}: ", kFrame);
  const std::size_t begin = text.find(before, line) + before.size();
  std::string list = text.substr(begin, text.find('\n', begin) - begin);
  for (char& c : list)
    if (std::string("[](),").find(c) != std::string::npos) c = ' ';
  std::istringstream words(list);
  std::vector<double> numbers;
  for (std::string word; words >> word;) numbers.push_back(std::strtod(word.c_str(), nullptr));
  return numbers;
}

int count_of(const std::string& text, const std::string& part) {
  int count = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++count;
  return count;
}

/// Every bracket is closed, in order, and nothing is closed twice.
void expect_balanced(const std::string& text) {
  std::string open;
  for (const char c : text) {
    if (c == '(' || c == '[' || c == '{') open += c;
    if (c != ')' && c != ']' && c != '}') continue;
    ASSERT_FALSE(open.empty());
    ASSERT_EQ(std::string(")]}")[std::string("([{").find(open.back())], c) << text.substr(0, 300);
    open.pop_back();
  }
  EXPECT_EQ(open, "");
}

/// Numbers that have no short decimal form.
struct Ball {
  explicit Ball(const Vec3& center) : surface(sphere_surface({center, 0.3})) {
    const std::size_t n = surface.vertices.size();
    for (const Vec3& x : surface.vertices) normal.push_back((x - center).normalized());
    colour.assign(n, Rgb{188, 10, 55});
    texture = seamless_texture(surface.vertices, surface.triangles, bounding_box(surface.vertices),
                               TextureProjection::box);
    PointArray rest{"rest", 3, {}, NumberType::float64}, velocity{"velocity", 3, {}, NumberType::float32},
        id{"id", 1, {}, NumberType::int64}, curvature{"mean_curvature", 1, {}, NumberType::float32};
    for (std::size_t v = 0; v < n; ++v) {
      for (const double c : surface.vertices[v]) rest.values.push_back(c);
      for (int c = 0; c < 3; ++c)
        velocity.values.push_back(std::sin(3.0 * static_cast<double>(v) + c) * 1e-3);
      id.values.push_back(10 + static_cast<double>(v));
      curvature.values.push_back(1 / 0.3);
    }
    arrays = {rest, velocity, id, curvature};
  }
  TexturedMesh mesh() const {
    return {surface.vertices, normal, texture.value, colour, surface.triangles, texture.corners, arrays};
  }

  TriangleSurface surface;
  std::vector<Vec3> normal;
  std::vector<Rgb> colour;
  SeamlessTexture texture;
  std::vector<PointArray> arrays;
};

TEST(Usd, SurfaceFramesHoldEveryNumber) {
  const Ball ball(Vec3(0.1, 0.2, 0.3));
  const TexturedMesh mesh = ball.mesh();
  const std::string text = usd_surface_frame(kFrame, mesh, Vec3::Zero());
  expect_balanced(text);
  EXPECT_TRUE(text.starts_with("#usda 1.0\n\nover \"Surface\"\n{\n"));
  const std::size_t n = mesh.position.size(), triangles = mesh.triangles.size();
  const std::vector<double> points = numbers_of(text, "point3f[] points"),
                            rest = numbers_of(text, "float3[] primvars:rest"),
                            velocity = numbers_of(text, "vector3f[] velocities"),
                            normal = numbers_of(text, "normal3f[] normals"),
                            colour = numbers_of(text, "color3f[] primvars:displayColor"),
                            id = numbers_of(text, "int[] primvars:id"),
                            corners = numbers_of(text, "int[] faceVertexIndices"),
                            st = numbers_of(text, "texCoord2f[] primvars:st"),
                            st_corners = numbers_of(text, "int[] primvars:st:indices");
  ASSERT_EQ(points.size(), 3 * n);
  ASSERT_EQ(rest.size(), 3 * n);
  ASSERT_EQ(velocity.size(), 3 * n);
  ASSERT_EQ(normal.size(), 3 * n);
  ASSERT_EQ(colour.size(), 3 * n);
  ASSERT_EQ(id.size(), n);
  ASSERT_EQ(corners.size(), 3 * triangles);
  ASSERT_EQ(st_corners.size(), 3 * triangles);
  ASSERT_EQ(st.size(), 2 * mesh.texture.size());
  EXPECT_EQ(numbers_of(text, "int[] faceVertexCounts"), std::vector<double>(triangles, 3));
  EXPECT_EQ(numbers_of(text, "float[] primvars:mean_curvature"),
            std::vector<double>(n, std::strtod("3.3333333", nullptr)));
  EXPECT_TRUE(numbers_of(text, "int[] primvars:source").empty()) << "the mesh has none";
  for (std::size_t i = 0; i < 3 * n; ++i) {
    const auto single = [](double x) { return static_cast<float>(x); };
    EXPECT_EQ(single(points[i]), single(mesh.position[i / 3][i % 3]));
    EXPECT_EQ(single(rest[i]), single(ball.arrays[0].values[i]));
    EXPECT_EQ(single(velocity[i]), single(ball.arrays[1].values[i]));
    EXPECT_NEAR(normal[i], mesh.normal[i / 3][i % 3], 5.1e-6);
  }
  EXPECT_NEAR(colour[0], 0.5029, 1e-4) << "sRGB 188 as light";
  for (std::size_t v = 0; v < n; ++v) EXPECT_EQ(id[v], 10 + static_cast<double>(v));
  for (std::size_t c = 0; c < 3 * triangles; ++c) {
    EXPECT_EQ(corners[c], mesh.triangles[c / 3][c % 3]);
    EXPECT_EQ(st_corners[c], mesh.corners[c / 3][c % 3]);
  }
}

TEST(Usd, FramesAreTheSameBytesEveryTime) {
  const Ball ball(Vec3::Zero());
  EXPECT_EQ(usd_surface_frame(3, ball.mesh(), Vec3::Zero()), usd_surface_frame(3, ball.mesh(), Vec3::Zero()));
}

TEST(Usd, AFrameWithoutVerticesIsAFrame) {
  const std::string text = usd_surface_frame(kFrame, {}, Vec3(1, 2, 3));
  expect_balanced(text);
  EXPECT_NE(text.find("7: [],"), std::string::npos);
  EXPECT_EQ(numbers_of(text, "float3[] extent"), std::vector<double>(6, 0.0));
}

// Single precision has half a metre there, and less than a micrometre about the middle.
TEST(Usd, FarMeshesAreAboutTheOriginOfTheWorld) {
  const Ball ball(Vec3(5e6, 1e7, -2e6));
  const Vec3 origin = far_origin(ball.surface.vertices);
  const std::string text = usd_surface_frame(kFrame, ball.mesh(), origin);
  for (const char* name : {"point3f[] points", "float3[] primvars:rest"}) {
    const std::vector<double> numbers = numbers_of(text, name);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      EXPECT_NEAR(origin[static_cast<int>(i % 3)] + numbers[i], ball.surface.vertices[i / 3][i % 3], 1e-7);
  }
  const std::string root =
      usd_surface_root({25, false, origin}, {"surface-total", "surface-total/surface", "m", 2});
  EXPECT_NE(
      root.find(fmt::format("double3 xformOp:translate = ({}, {}, {})", origin[0], origin[1], origin[2])),
      std::string::npos);
}

// What USD reads, and by which a file that validates brings no data when it is wrong.
TEST(Usd, RootsNameTheClipsAndDeclareWhatVaries) {
  const UsdPrim prim{"surface-curvature-only", "surface-curvature-only/surface",
                     "surface-curvature-only/manifest.usda", 76};
  const std::string root = usd_surface_root({1 / 0.04, true, Vec3::Zero()}, prim);
  expect_balanced(root);
  for (const char* part : {"defaultPrim = \"World\"", "metersPerUnit = 1", "upAxis = \"Z\"",
                           "startTimeCode = 0", "endTimeCode = 75", "timeCodesPerSecond = 25\n",
                           "framesPerSecond = 25\n", "def Mesh \"surface_curvature_only\" (",
                           "asset manifestAssetPath = @./surface-curvature-only/manifest.usda@",
                           "string primPath = \"/Surface\"",
                           "string templateAssetPath = \"./surface-curvature-only/surface.####.usda\"",
                           "double templateStartTime = 0", "double templateEndTime = 75",
                           "double templateStride = 1", "uniform token subdivisionScheme = \"none\""})
    EXPECT_EQ(count_of(root, part), 1) << part;
  EXPECT_EQ(root.find("xformOp"), std::string::npos);
  const std::string frame = usd_surface_frame(0, Ball(Vec3::Zero()).mesh(), Vec3::Zero()),
                    manifest = usd_surface_manifest();
  expect_balanced(manifest);
  for (std::size_t at = 0; (at = frame.find(".timeSamples", at)) != std::string::npos; ++at) {
    const std::size_t begin = frame.rfind('\n', at) + 1;
    const std::string declared = frame.substr(begin, at - begin).substr(4);
    EXPECT_EQ(count_of(manifest, "    " + declared + "\n") + count_of(manifest, "    " + declared + " (\n"),
              1)
        << declared;
    EXPECT_EQ(count_of(root, "        " + declared + "\n") + count_of(root, "        " + declared + " (\n"),
              1)
        << declared;
  }
  EXPECT_EQ(count_of(root, "interpolation = \"faceVarying\""), 1);
}

TEST(Usd, ParticlesHaveWidthsAndIds) {
  PointData particles;
  particles.position = {{0.1, 0.2, 0.3}, {1, 2, 3}};
  particles.arrays = {{"id", 1, {5, 1e10}, NumberType::int64},
                      {"velocity", 3, {1, 2, 3, 4, 5, 6}, NumberType::float32},
                      {"density", 1, {1000, 1001}, NumberType::float32},
                      {"sigma", 1, {0.1, 0.3}, NumberType::float32}};
  const std::string text = usd_particles_frame(kFrame, particles, Vec3::Zero());
  expect_balanced(text);
  EXPECT_EQ(numbers_of(text, "int64[] ids"), (std::vector<double>{5, 1e10}));
  EXPECT_EQ(numbers_of(text, "float[] widths"), (std::vector<double>{0.05, 0.15}));
  EXPECT_EQ(numbers_of(text, "vector3f[] velocities"), (std::vector<double>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(count_of(text, "timeSamples"), 5) << "and points and extent";
  EXPECT_EQ(count_of(usd_particles_root({}, {"particles", "particles/particles", "m", 1}), "def Points"), 1);
}

// USD: the transform is translate after orient, which is w, x, y, z.
TEST(Usd, WallsMoveByTheirTransforms) {
  const std::vector<TriangleSurface> start{box_surface({Vec3(1, 2, 3), Vec3(2, 4, 3.5)}),
                                           sphere_surface({Vec3(-1, 0, 0), 0.2})};
  const RigidPose pose{Eigen::AngleAxisd(2.8, Vec3(1, 2, -2).normalized()).toRotationMatrix(),
                       Vec3(0.3, -5, 1)};
  const std::vector<TriangleSurface> now{moved(start[0], pose), start[1]};
  const std::vector<UsdWall> walls = usd_walls(start);
  const std::string text = usd_walls_frame(kFrame, walls, now, Vec3::Zero());
  expect_balanced(text);
  for (std::size_t w = 0; w < 2; ++w) {
    const std::string part = text.substr(text.find(fmt::format("over \"wall_{}\"", w)));
    const std::vector<double> translate = numbers_of(part, "double3 xformOp:translate"),
                              orient = numbers_of(part, "quatf xformOp:orient");
    ASSERT_EQ(translate.size(), 3u);
    ASSERT_EQ(orient.size(), 4u);
    const Eigen::Quaterniond q(orient[0], orient[1], orient[2], orient[3]);
    EXPECT_NEAR(q.norm(), 1, 1e-6);
    for (std::size_t v = 0; v < start[w].vertices.size(); ++v)
      EXPECT_LT(
          (q * (start[w].vertices[v] - walls[w].middle) + Vec3(translate.data()) - now[w].vertices[v]).norm(),
          1e-6);
  }
  const std::string meshes = usd_wall_meshes({}, walls, true), manifest = usd_walls_manifest(2);
  expect_balanced(meshes);
  expect_balanced(manifest);
  EXPECT_EQ(count_of(meshes, "def Mesh"), 2);
  EXPECT_EQ(count_of(meshes, "interpolation = \"uniform\""), 2);
  EXPECT_NE(meshes.find("normal3f[] normals = [("), std::string::npos);
  EXPECT_EQ(count_of(meshes, "xformOpOrder = [\"xformOp:translate\", \"xformOp:orient\"]"), 2);
  EXPECT_EQ(count_of(manifest, "quatf xformOp:orient"), 2);
  EXPECT_EQ(count_of(usd_wall_meshes({}, walls, false), "xformOp"), 0);
}

TEST(Usd, WallsAreKnownByTheirArray) {
  const std::vector<TriangleSurface> walls{box_surface({Vec3(1, 2, 3), Vec3(2, 4, 3.5)}),
                                           sphere_surface({Vec3(-1, 0, 0), 0.2})};
  const std::vector<TriangleSurface> found = exported_walls(*boundary_data(walls));
  ASSERT_EQ(found.size(), 2u);
  for (std::size_t w = 0; w < 2; ++w) {
    ASSERT_EQ(found[w].triangles.size(), walls[w].triangles.size());
    EXPECT_EQ(found[w].vertices.size(), walls[w].vertices.size());
    for (std::size_t t = 0; t < walls[w].triangles.size(); ++t)
      for (int c = 0; c < 3; ++c)
        EXPECT_EQ(found[w].vertices[found[w].triangles[t][c]], walls[w].vertices[walls[w].triangles[t][c]]);
  }
}

}  // namespace
}  // namespace kappaflow
