#include "tools/io/usd_walls.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <array>
#include <numeric>

#include "core/triangle_geometry.h"
#include "surface/measure/texture.h"

namespace kappaflow {
namespace {

constexpr const char* kWallsPrim = "Walls";
constexpr UsdAttribute kTranslate{"double3", "xformOp:translate"}, kOrient{"quatf", "xformOp:orient"};
constexpr std::array kPose{kTranslate, kOrient};

std::string wall_name(std::size_t w) {
  return fmt::format("wall_{}", w);
}

Vec3 mean_of(std::span<const Vec3> position) {
  const Vec3 sum = std::accumulate(position.begin(), position.end(), Vec3(Vec3::Zero()));
  return sum / static_cast<double>(std::max<std::size_t>(position.size(), 1));
}

/// The rotation about the means that takes the points nearest to where they are now. Kabsch, Acta
/// Crystallographica A 32, 1976.
Eigen::Quaternionf rotation_to(const UsdWall& wall, std::span<const Vec3> now, const Vec3& middle_now) {
  Mat3 sum = Mat3::Zero();
  for (std::size_t v = 0; v < now.size(); ++v)
    sum += (now[v] - middle_now) * (wall.surface.vertices[v] - wall.middle).transpose();
  const Eigen::JacobiSVD<Mat3> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Mat3 rotation = svd.matrixU() * Vec3(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0) q.coeffs() *= -1;
  return q.cast<float>();
}

/// Of the faces, so that edges are sharp whatever a program makes of a mesh without normals.
std::vector<Vec3> face_normals(const TriangleSurface& surface) {
  std::vector<Vec3> normals;
  normals.reserve(surface.triangles.size());
  for (const Triangle& t : surface.triangles) {
    const Vec3 &a = surface.vertices[t[0]], &b = surface.vertices[t[1]], &c = surface.vertices[t[2]];
    normals.push_back(twice_area_vector(a, b, c).normalized());
  }
  return normals;
}

std::string mesh_text(const UsdWall& wall, std::size_t w, const Vec3& from, bool moving) {
  const Bounds box = bounding_box(wall.surface.vertices);
  const std::vector<std::int64_t> counts(wall.surface.triangles.size(), 3);
  std::string text = fmt::format("\n    def Mesh \"{}\"\n    {{\n", wall_name(w));
  text += "        uniform token subdivisionScheme = \"none\"\n";
  text += fmt::format("        float3[] extent = {}\n", usd_list(std::array{box.lower, box.upper}, from));
  text += fmt::format("        int[] faceVertexCounts = {}\n", usd_list(counts));
  text += fmt::format("        int[] faceVertexIndices = {}\n", usd_list(wall.surface.triangles));
  text += fmt::format("        point3f[] points = {}\n", usd_list(wall.surface.vertices, from));
  text +=
      fmt::format("        normal3f[] normals = {} (\n            interpolation = \"uniform\"\n        )\n",
                  usd_list(face_normals(wall.surface), Vec3::Zero(), 5));
  if (moving)
    text += usd_declarations(kPose, 8) +
            "        uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:orient\"]\n";
  return text + "    }\n";
}

}  // namespace

std::vector<UsdWall> usd_walls(std::span<const TriangleSurface> walls) {
  std::vector<UsdWall> result;
  for (const TriangleSurface& wall : walls) result.push_back({wall, mean_of(wall.vertices)});
  return result;
}

std::string usd_wall_meshes(const UsdStage& stage, std::span<const UsdWall> walls, bool moving) {
  std::string text = fmt::format("#usda 1.0\n(\n    defaultPrim = \"{}\"\n)\n\ndef Xform \"{}\"\n{{",
                                 kWallsPrim, kWallsPrim);
  for (std::size_t w = 0; w < walls.size(); ++w)
    text += mesh_text(walls[w], w, moving ? walls[w].middle : stage.origin, moving);
  return text + "}\n";
}

std::string usd_walls_frame(int frame, std::span<const UsdWall> walls, std::span<const TriangleSurface> now,
                            const Vec3& origin) {
  std::string text = fmt::format("#usda 1.0\n\nover \"{}\"\n{{\n", kWallsPrim);
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const Vec3 middle = mean_of(now[w].vertices), at = middle - origin;
    const Eigen::Quaternionf q = rotation_to(walls[w], now[w].vertices, middle);
    text += fmt::format("    over \"{}\"\n    {{\n", wall_name(w));
    text += usd_sample(kTranslate, frame, fmt::format("({}, {}, {})", at[0], at[1], at[2]), 8);
    text += usd_sample(kOrient, frame, fmt::format("({}, {}, {}, {})", q.w(), q.x(), q.y(), q.z()), 8);
    text += "    }\n";
  }
  return text + "}\n";
}

std::string usd_walls_manifest(std::size_t count) {
  std::string text = fmt::format("#usda 1.0\n\nover \"{}\"\n{{\n", kWallsPrim);
  for (std::size_t w = 0; w < count; ++w)
    text += fmt::format("    over \"{}\"\n    {{\n{}    }}\n", wall_name(w), usd_declarations(kPose, 8));
  return text + "}\n";
}

std::string usd_walls_root(const UsdStage& stage, const UsdPrim& prim, const std::string& meshes,
                           bool moving) {
  std::string metadata = fmt::format("        references = @./{}@\n", meshes);
  if (moving) metadata += usd_clips(prim.stem, prim.manifest, kWallsPrim, prim.frames);
  return usd_header(stage, prim.frames) +
         usd_world(stage, fmt::format("    def Xform \"{}\" (\n{}    )\n    {{\n    }}\n",
                                      usd_name(prim.name), metadata));
}

}  // namespace kappaflow
