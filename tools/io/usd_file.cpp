#include "tools/io/usd_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "surface/measure/texture.h"
#include "tools/io/exported_arrays.h"

namespace kappaflow {
namespace {

constexpr UsdAttribute kPoints{"point3f[]", "points"}, kExtent{"float3[]", "extent"},
    kVelocities{"vector3f[]", "velocities"};

constexpr UsdAttribute kCounts{"int[]", "faceVertexCounts"}, kIndices{"int[]", "faceVertexIndices"},
    kNormals{"normal3f[]", "normals", "vertex"}, kTexture{"texCoord2f[]", "primvars:st", "faceVarying"},
    kTextureIndices{"int[]", "primvars:st:indices"}, kColour{"color3f[]", "primvars:displayColor", "vertex"};

/// What a surface's or the particles' arrays become. Blender drops whole numbers of 64 bits and the types
/// that are more particular, and takes the velocity for motion blur from the schema's own attribute only.
struct UsdArray {
  std::string_view array;
  UsdAttribute attribute;
};
constexpr UsdArray kSurfaceArrays[] = {
    {"velocity", kVelocities},
    {"rest", {"float3[]", "primvars:rest", "vertex"}},
    {"rest_1", {"float3[]", "primvars:rest_1", "vertex"}},
    {"rest_2", {"float3[]", "primvars:rest_2", "vertex"}},
    {"rest_2_weight", {"float[]", "primvars:rest_2_weight", "vertex"}},
    {"id", {"int[]", "primvars:id", "vertex"}},
    {"source", {"int[]", "primvars:source", "vertex"}},
    {"temperature", {"float[]", "primvars:temperature", "vertex"}},
    {"mean_curvature", {"float[]", "primvars:mean_curvature", "vertex"}},
    {"gaussian_curvature", {"float[]", "primvars:gaussian_curvature", "vertex"}},
    {"confidence", {"float[]", "primvars:confidence", "vertex"}},
    {"material_slip", {"float[]", "primvars:material_slip", "vertex"}}};
constexpr UsdArray kParticleArrays[] = {{"velocity", kVelocities},
                                        {"id", {"int64[]", "ids"}},
                                        {"source", {"int[]", "primvars:source", "vertex"}},
                                        {"temperature", {"float[]", "primvars:temperature", "vertex"}},
                                        {"sigma", {"float[]", "widths", "vertex"}}};

std::string value_of(const PointArray& array, std::string_view type, const Vec3& origin) {
  if (type == "int[]" || type == "int64[]") {
    std::vector<std::int64_t> whole;
    for (const double x : array.values)
      whole.push_back(type == "int[]" ? whole_of_32_bits(x) : static_cast<std::int64_t>(x));
    return usd_list(whole);
  }
  std::vector<float> numbers;
  numbers.reserve(array.values.size());
  const double share = array.name == "sigma" ? 0.5 : 1;  // the width of a particle
  for (std::size_t i = 0; i < array.values.size(); ++i) {
    const double from = is_rest_position(array) ? origin[static_cast<Eigen::Index>(i % 3)] : 0;
    numbers.push_back(static_cast<float>(share * array.values[i] - from));
  }
  return usd_list(numbers, static_cast<int>(array.components));
}

std::string array_samples(std::span<const UsdArray> known, std::span<const PointArray> arrays, int frame,
                          const Vec3& origin) {
  std::string text;
  for (const PointArray& array : arrays)
    for (const UsdArray& k : known)
      if (k.array == array.name)
        text += usd_sample(k.attribute, frame, value_of(array, k.attribute.type, origin));
  return text;
}

/// The box around the points, and spheres of that radius about them.
std::string extent_of(std::span<const Vec3> position, const Vec3& origin, double radius) {
  if (position.empty()) return "[(0,0,0),(0,0,0)]";
  const Bounds box = bounding_box(position);
  const Vec3 around = Vec3::Constant(radius);
  return usd_list(std::array<Vec3, 2>{box.lower - around, box.upper + around}, origin);
}

std::string colours_of(std::span<const Rgb> colours) {
  std::vector<Vec3> light;
  for (const Rgb& c : colours) light.emplace_back(linear_light(c[0]), linear_light(c[1]), linear_light(c[2]));
  return usd_list(light, Vec3::Zero(), 4);
}

std::string texture_of(std::span<const Vec2> texture) {
  std::vector<float> numbers;
  for (const Vec2& t : texture)
    for (const double c : t) numbers.push_back(static_cast<float>(c));
  return usd_list(numbers, 2);
}

std::string clip_text(std::string_view prim, const std::string& samples) {
  return fmt::format("#usda 1.0\n\nover \"{}\"\n{{\n{}}}\n", prim, samples);
}

std::vector<UsdAttribute> with_arrays(std::vector<UsdAttribute> attributes,
                                      std::span<const UsdArray> arrays) {
  for (const UsdArray& array : arrays) attributes.push_back(array.attribute);
  return attributes;
}

std::vector<UsdAttribute> surface_attributes() {
  return with_arrays({kPoints, kExtent, kCounts, kIndices, kNormals, kTexture, kTextureIndices, kColour},
                     kSurfaceArrays);
}

std::vector<UsdAttribute> particle_attributes() {
  return with_arrays({kPoints, kExtent}, kParticleArrays);
}

constexpr const char* kSurfacePrim = "Surface";
constexpr const char* kParticlesPrim = "Particles";

/// head: first line of the prim. body: what is in it.
std::string root_text(const UsdStage& stage, const UsdPrim& prim, const std::string& head,
                      std::string_view clip_prim, const std::string& body) {
  const std::string clips = usd_clips(prim.stem, prim.manifest, clip_prim, prim.frames);
  return usd_header(stage, prim.frames) +
         usd_world(stage, fmt::format("    def {} (\n{}    )\n    {{\n{}    }}\n", head, clips, body));
}

}  // namespace

std::string usd_surface_frame(int frame, const TexturedMesh& mesh, const Vec3& origin) {
  const std::vector<std::int64_t> counts(mesh.triangles.size(), 3);
  return clip_text(kSurfacePrim, usd_sample(kPoints, frame, usd_list(mesh.position, origin)) +
                                     usd_sample(kExtent, frame, extent_of(mesh.position, origin, 0)) +
                                     usd_sample(kCounts, frame, usd_list(counts)) +
                                     usd_sample(kIndices, frame, usd_list(mesh.triangles)) +
                                     usd_sample(kNormals, frame, usd_list(mesh.normal, Vec3::Zero(), 5)) +
                                     usd_sample(kTexture, frame, texture_of(mesh.texture)) +
                                     usd_sample(kTextureIndices, frame, usd_list(mesh.corners)) +
                                     usd_sample(kColour, frame, colours_of(mesh.colour)) +
                                     array_samples(kSurfaceArrays, mesh.arrays, frame, origin));
}

std::string usd_surface_manifest() {
  return usd_manifest(kSurfacePrim, surface_attributes());
}

std::string usd_surface_root(const UsdStage& stage, const UsdPrim& prim) {
  return root_text(
      stage, prim, fmt::format("Mesh \"{}\"", usd_name(prim.name)), kSurfacePrim,
      "        uniform token subdivisionScheme = \"none\"\n" + usd_declarations(surface_attributes(), 8));
}

std::string usd_particles_frame(int frame, const PointData& particles, const Vec3& origin) {
  const PointArray* const sigma = find_array(particles.arrays, {"sigma"}, 1);
  const double largest =
      sigma == nullptr || sigma->values.empty() ? 0 : *std::ranges::max_element(sigma->values);
  return clip_text(kParticlesPrim,
                   usd_sample(kPoints, frame, usd_list(particles.position, origin)) +
                       usd_sample(kExtent, frame, extent_of(particles.position, origin, largest / 4)) +
                       array_samples(kParticleArrays, particles.arrays, frame, origin));
}

std::string usd_particles_manifest() {
  return usd_manifest(kParticlesPrim, particle_attributes());
}

std::string usd_particles_root(const UsdStage& stage, const UsdPrim& prim) {
  return root_text(stage, prim, fmt::format("Points \"{}\"", usd_name(prim.name)), kParticlesPrim,
                   usd_declarations(particle_attributes(), 8));
}

}  // namespace kappaflow
