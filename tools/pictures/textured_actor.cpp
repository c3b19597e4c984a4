#include "tools/pictures/textured_actor.h"

#include <fmt/format.h>
#include <vtkDataObject.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkShaderProperty.h>
#include <vtkTexture.h>

#include <string>
#include <string_view>

#include "tools/pictures/embedded_files.h"
#include "tools/pictures/surface_arrays.h"

namespace kappaflow {
namespace {

// The mean over a pixel is taken of 4 x 4 points, for VTK evaluates a fragment once.
constexpr const char* kMeanColour = R"(
vec3 meanColour() {{
  vec3 right = dFdx(placeVSOutput), up = dFdy(placeVSOutput), sum = vec3(0.0);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      sum += {}Colour(placeVSOutput + (0.25 * float(i) - 0.375) * right + (0.25 * float(j) - 0.375) * up);
  return sum / 16.0;
}}
)";

// texture_coordinates() of a place that is -1 to 1 in the box around the first mesh.
constexpr std::string_view kCoordinates[] = {
    "0.5 + 0.5 * r.xy",
    "vec2(0.5 + atan(r.z, r.x) / 6.283185307, 0.5 + atan(r.y, length(r.xz)) / 3.141592654)",
    "0.5 + 0.5 * (abs(r.x) >= max(abs(r.y), abs(r.z)) ? r.zy : abs(r.y) >= abs(r.z) ? r.xz : r.xy)"};

std::string colour_code(const SolidTexture& texture) {
  using Kind = SolidTexture::Kind;
  switch (texture.kind) {
    case Kind::checker:
      return std::string(kTextureColours) + fmt::format(kMeanColour, "checker");
    case Kind::stripes:
      return std::string(kTextureColours) + fmt::format(kMeanColour, "stripes");
    case Kind::grid:
      return std::string(kTextureColours) + fmt::format(kMeanColour, "grid");
    case Kind::image:
      break;
  }
  return fmt::format("vec3 imageColour(vec3 r) {{ return textureLod(picture, {}, 0.0).rgb; }}\n",
                     kCoordinates[static_cast<std::size_t>(texture.projection)]) +
         fmt::format(kMeanColour, "image");
}

/// Where textures are functions of (rest position - origin) / edge, axis by axis.
struct Places {
  Vec3 origin, edge;
};

/// The checker's cubes, or for images the box, from its middle in halves of its edges.
Places places_of(vtkPolyData& surface, const SolidTexture& texture) {
  if (texture.kind == SolidTexture::Kind::image)
    return {0.5 * (texture.box.lower + texture.box.upper),
            (0.5 * (texture.box.upper - texture.box.lower)).cwiseMax(1e-300)};
  const Checker checker = checker_of(surface);
  return {checker.origin, Vec3::Constant(checker.edge)};
}

/// The surface with rest positions as textures take them. Without texture coordinates, which VTK would lay
/// the image along too.
vtkSmartPointer<vtkPolyData> with_places(vtkPolyData& surface, const Places& places) {
  vtkDataArray& rest = array_in(*surface.GetPointData(), "rest_position", 3, surface.GetNumberOfPoints());
  vtkNew<vtkFloatArray> place;
  place->SetName("place");
  place->SetNumberOfComponents(3);
  place->SetNumberOfTuples(rest.GetNumberOfTuples());
  for (vtkIdType v = 0; v < rest.GetNumberOfTuples(); ++v)
    for (int a = 0; a < 3; ++a)
      place->SetComponent(v, a, (rest.GetComponent(v, a) - places.origin[a]) / places.edge[a]);
  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->ShallowCopy(&surface);
  result->GetPointData()->SetTCoords(nullptr);
  result->GetPointData()->AddArray(place);
  return result;
}

void add_image(vtkActor& actor, vtkImageData& image) {
  vtkNew<vtkTexture> texture;
  texture->SetInputData(&image);
  texture->InterpolateOn();
  texture->RepeatOff();
  texture->EdgeClampOn();
  actor.GetProperty()->SetTexture("picture", texture);
}

void add_shaders(vtkActor& actor, const std::string& colour) {
  const auto after = [](const std::string& tag, const std::string& code) { return tag + "\n" + code + "\n"; };
  vtkShaderProperty& shader = *actor.GetShaderProperty();
  const std::string declare = "//VTK::Normal::Dec", implement = "//VTK::Normal::Impl",
                    images = "//VTK::TMap::Dec", paint = "//VTK::Color::Impl";
  shader.AddVertexShaderReplacement(declare, true, after(declare, "in vec3 place;\nout vec3 placeVSOutput;"),
                                    false);
  shader.AddVertexShaderReplacement(implement, true, after(implement, "placeVSOutput = place;"), false);
  shader.AddFragmentShaderReplacement(images, true, after(images, "in vec3 placeVSOutput;\n" + colour),
                                      false);
  shader.AddFragmentShaderReplacement(
      paint, true,
      after(paint, "vec3 textured = meanColour();\nambientColor *= textured;\ndiffuseColor *= textured;"),
      false);
}

}  // namespace

vtkSmartPointer<vtkActor> textured_actor(vtkPolyData& surface, const SolidTexture& texture) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(with_places(surface, places_of(surface, texture)));
  mapper->ScalarVisibilityOff();
  mapper->MapDataArrayToVertexAttribute("place", "place", vtkDataObject::FIELD_ASSOCIATION_POINTS, -1);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  add_shaders(*actor, colour_code(texture));
  if (texture.image) add_image(*actor, *texture.image);
  actor->GetProperty()->SetColor(1, 1, 1);
  return actor;
}

}  // namespace kappaflow
