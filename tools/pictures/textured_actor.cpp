#include "tools/pictures/checker_actor.h"

#include <fmt/format.h>
#include <vtkDataObject.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkShaderProperty.h>

#include <string>

#include "tools/pictures/embedded_files.h"
#include "tools/pictures/surface_arrays.h"

namespace kappaflow {
namespace {

// The solid checker of checker_colours() for every pixel: `cube` is the rest position in units of the cubes.
// The mean over a pixel is taken of 4 x 4 points, for VTK evaluates a fragment once.
constexpr const char* kCheckerColour = R"(
vec3 checkerColour() {
  vec3 right = dFdx(cubeVSOutput), up = dFdy(cubeVSOutput), sum = vec3(0.0);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      sum += cubeColour(cubeVSOutput + (0.25 * float(i) - 0.375) * right + (0.25 * float(j) - 0.375) * up);
  return sum / 16.0;
}
)";

/// The surface with rest positions in units of the checker's cubes, from one of their corners.
vtkSmartPointer<vtkPolyData> with_cubes(vtkPolyData& surface) {
  vtkDataArray& rest = array_in(*surface.GetPointData(), "rest_position", 3, surface.GetNumberOfPoints());
  const Checker checker = checker_of(surface);
  vtkNew<vtkFloatArray> cube;
  cube->SetName("cube");
  cube->SetNumberOfComponents(3);
  cube->SetNumberOfTuples(rest.GetNumberOfTuples());
  for (vtkIdType v = 0; v < rest.GetNumberOfTuples(); ++v)
    for (int a = 0; a < 3; ++a)
      cube->SetComponent(v, a, (rest.GetComponent(v, a) - checker.origin[a]) / checker.edge);
  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->ShallowCopy(&surface);
  result->GetPointData()->AddArray(cube);
  return result;
}

}  // namespace

vtkSmartPointer<vtkActor> checker_actor(vtkPolyData& surface) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(with_cubes(surface));
  mapper->ScalarVisibilityOff();
  mapper->MapDataArrayToVertexAttribute("cube", "cube", vtkDataObject::FIELD_ASSOCIATION_POINTS, -1);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  const auto append = [](const std::string& tag, const std::string& code) {
    return tag + "\n" + code + "\n";
  };
  vtkShaderProperty& shader = *actor->GetShaderProperty();
  const std::string declare = "//VTK::Normal::Dec", implement = "//VTK::Normal::Impl";
  shader.AddVertexShaderReplacement(declare, true, append(declare, "in vec3 cube;\nout vec3 cubeVSOutput;"),
                                    false);
  shader.AddVertexShaderReplacement(implement, true, append(implement, "cubeVSOutput = cube;"), false);
  shader.AddFragmentShaderReplacement(
      declare, true, append(declare, fmt::format("in vec3 cubeVSOutput;\n{}{}", kCubeColour, kCheckerColour)),
      false);
  shader.AddFragmentShaderReplacement(
      "//VTK::Color::Impl", true,
      append("//VTK::Color::Impl",
             "vec3 checker = checkerColour();\nambientColor *= checker;\ndiffuseColor *= checker;"),
      false);
  actor->GetProperty()->SetColor(1, 1, 1);
  return actor;
}

}  // namespace kappaflow
