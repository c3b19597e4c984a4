#include "tools/io/vtp_files.h"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCommand.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <limits>
#include <type_traits>

#include "core/errors.h"
#include "core/read_file.h"
#include "core/text_scanner.h"
#include "tools/io/files.h"
#include "tools/io/vtk_xml.h"

namespace kappaflow {
namespace {

// Array: a VTK array class. value(i): a number, or anything with operator[] when there are several
// components.
template <class Array, class Value>
vtkSmartPointer<Array> make_array(const char* name, int components, std::size_t n, const Value& value) {
  auto array = vtkSmartPointer<Array>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(n));
  using Number = typename Array::ValueType;
  Number* out = array->GetPointer(0);
  for (std::size_t i = 0; i < n; ++i) {
    const auto& tuple = value(i);
    if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(tuple)>>)
      *out++ = static_cast<Number>(tuple);
    else
      for (int c = 0; c < components; ++c) *out++ = static_cast<Number>(tuple[c]);
  }
  return array;
}

// The array of a span: double in memory, single precision in the file unless Array says otherwise.
template <class Array = vtkFloatArray, class Span>
vtkSmartPointer<Array> make_array(const char* name, int components, const Span& values) {
  return make_array<Array>(
      name, components, values.size(), [&](std::size_t i) -> const auto& { return values[i]; });
}

// The points keep double precision: a mesh read back from its file still lies on the surface.
vtkSmartPointer<vtkPoints> make_points(std::span<const Vec3> positions) {
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetData(make_array<vtkDoubleArray>("Points", 3, positions));
  return points;
}

vtkSmartPointer<vtkCellArray> make_triangles(std::span<const Triangle> triangles) {
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->AllocateExact(static_cast<vtkIdType>(triangles.size()),
                       3 * static_cast<vtkIdType>(triangles.size()));
  for (const Triangle& t : triangles) cells->InsertNextCell({t[0], t[1], t[2]});
  return cells;
}

void set_time(vtkPolyData& data, double time) {
  data.GetFieldData()->AddArray(
      make_array<vtkDoubleArray>("TimeValue", 1, 1, [&](std::size_t) { return time; }));
}

vtkSmartPointer<vtkDataArray> make_added_array(const std::string& name, const std::vector<double>& values) {
  return make_array<vtkDoubleArray>(name.c_str(), 1, values);
}
vtkSmartPointer<vtkDataArray> make_added_array(const std::string& name, const std::vector<Vec3>& values) {
  return make_array<vtkDoubleArray>(name.c_str(), 3, values);
}
vtkSmartPointer<vtkDataArray> make_added_array(const std::string& name, const std::vector<int>& values) {
  return make_array<vtkIntArray>(name.c_str(), 1, values);
}

bool has_sources(const TriangleMesh& mesh) {
  return std::ranges::any_of(mesh.source, [](int s) { return s != kUnknownSource; });
}

// VTK prints its errors on the terminal unless somebody listens; ours go into an IoError.
class ErrorListener final : public vtkCommand {
 public:
  static ErrorListener* New() { return new ErrorListener; }
  void Execute(vtkObject*, unsigned long, void*) override { failed = true; }
  bool failed = false;
};

template <class Array>
vtkSmartPointer<Array> array_as(const PointArray& array) {
  using Number = typename Array::ValueType;
  using Limits = std::numeric_limits<Number>;
  constexpr std::size_t kMostComponents = 9;  // of a tensor
  if (array.components < 1 || array.components > kMostComponents)
    throw InvalidInput(fmt::format("array \"{}\" has {} components; expected 1 to {}",
                                   one_line(array.name, 30), array.components, kMostComponents));
  if constexpr (std::is_integral_v<Number>)
    for (const double value : array.values)
      if (!(value >= Limits::min() && value <= Limits::max()))
        throw InvalidInput(fmt::format("array \"{}\" has the number {}", one_line(array.name, 30), value));
  return make_array<Array>(array.name.c_str(), static_cast<int>(array.components),
                           array.values.size() / array.components,
                           [&](std::size_t i) { return array.values.data() + array.components * i; });
}

/// Int32 and UInt8 stay what they are: whole numbers may be names, and bytes colours.
vtkSmartPointer<vtkDataArray> array_to_draw(const PointArray& array) {
  if (array.type == NumberType::int32) return array_as<vtkIntArray>(array);
  if (array.type == NumberType::uint8) return array_as<vtkUnsignedCharArray>(array);
  return array_as<vtkDoubleArray>(array);
}

void check_finite_points(const PointData& data) {
  for (std::size_t v = 0; v < data.position.size(); ++v)
    if (!data.position[v].allFinite()) throw InvalidInput(fmt::format("vertex {} is nowhere", v));
}

}  // namespace

vtkSmartPointer<vtkPolyData> particle_data(const ParticleFrame& frame) {
  const Particles& particles = frame.particles;
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(make_points(particles.position));
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  for (vtkIdType i = 0; i < static_cast<vtkIdType>(particles.size()); ++i) cells->InsertNextCell({i});
  data->SetVerts(cells);

  vtkPointData& arrays = *data->GetPointData();
  arrays.AddArray(make_array<vtkTypeInt64Array>("id", 1, particles.id));
  arrays.AddArray(make_array("velocity", 3, particles.velocity));
  if (!frame.density.empty()) arrays.AddArray(make_array("density", 1, frame.density));
  if (!frame.pressure.empty()) arrays.AddArray(make_array("pressure", 1, frame.pressure));
  if (!frame.source.empty()) arrays.AddArray(make_array<vtkIntArray>("source", 1, frame.source));
  if (!frame.weight.empty()) {
    arrays.AddArray(make_array<vtkDoubleArray>("weight", 1, frame.weight));
    arrays.AddArray(
        make_array<vtkDoubleArray>("sigma", 1, particles.size(), [&](std::size_t) { return frame.sigma; }));
  }
  set_time(*data, particles.time);
  return data;
}

vtkSmartPointer<vtkPolyData> surface_data(const SurfaceFrame& frame) {
  const SurfaceState& state = frame.state;
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(make_points(frame.mesh.position));
  data->SetPolys(make_triangles(frame.mesh.triangles));

  vtkPointData& arrays = *data->GetPointData();
  arrays.SetNormals(make_array("Normals", 3, state.normal));
  arrays.SetTCoords(make_array("TCoords", 2, frame.texture_coordinates));
  arrays.AddArray(make_array("velocity", 3, state.motion.velocity));
  arrays.AddArray(make_array("mean_curvature", 1, state.mean_curvature));
  arrays.AddArray(make_array("gaussian_curvature", 1, state.gaussian_curvature));
  arrays.AddArray(make_array("confidence", 1, state.motion.confidence));
  arrays.AddArray(make_array<vtkDoubleArray>("rest_position", 3, frame.mesh.rest_position));
  if (has_sources(frame.mesh)) arrays.AddArray(make_array<vtkIntArray>("source", 1, frame.mesh.source));
  arrays.AddArray(make_array<vtkTypeInt64Array>("id", 1, frame.mesh.id));
  arrays.AddArray(make_array<vtkUnsignedCharArray>("checker", 3, frame.checker));
  if (!state.material_slip.empty()) arrays.AddArray(make_array("material_slip", 1, state.material_slip));
  arrays.AddArray(make_array<vtkUnsignedCharArray>("unprojected", 1, frame.mesh.unprojected));
  for (const VertexArray& array : frame.mesh.added)
    std::visit([&](const auto& of) { arrays.AddArray(make_added_array(array.name, of.values)); }, array.data);
  set_time(*data, frame.time);
  return data;
}

vtkSmartPointer<vtkPolyData> boundary_data(std::span<const TriangleSurface> walls) {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  std::vector<int> wall_of;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const int first = static_cast<int>(vertices.size());
    vertices.insert(vertices.end(), walls[w].vertices.begin(), walls[w].vertices.end());
    for (const Triangle& t : walls[w].triangles)
      triangles.push_back({first + t[0], first + t[1], first + t[2]});
    wall_of.resize(triangles.size(), static_cast<int>(w));
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(make_points(vertices));
  data->SetPolys(make_triangles(triangles));
  data->GetCellData()->AddArray(make_array<vtkIntArray>("wall", 1, wall_of));
  return data;
}

void write_vtp(const std::filesystem::path& path, vtkPolyData& data) {
  auto writer = vtkSmartPointer<vtkXMLPolyDataWriter>::New();
  auto errors = vtkSmartPointer<ErrorListener>::New();
  writer->AddObserver(vtkCommand::ErrorEvent, errors);
  writer->SetInputData(&data);
  writer->SetDataModeToBinary();  // VTK's default, appended data, is not well-formed XML: ParaView 5.11
                                  // rejects it
  writer->SetCompressorTypeToZLib();
  writer->SetCompressionLevel(1);  // the fastest: floats hardly compress
  writer->WriteToOutputStringOn();
  if (writer->Write() == 0 || errors->failed) throw IoError(path.string(), "VTK cannot encode the data");
  write_file(path, writer->GetOutputString());
}

vtkSmartPointer<vtkPolyData> read_surface(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  try {
    const VtkSurface surface = parse_vtk_surface(bytes);
    check_finite_points(surface.points);
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(make_points(surface.points.position));
    data->SetPolys(make_triangles(surface.triangles));
    for (const PointArray& array : surface.points.arrays)
      data->GetPointData()->AddArray(array_to_draw(array));
    data->GetPointData()->SetActiveNormals("Normals");
    for (const PointArray& array : surface.points.fields)
      data->GetFieldData()->AddArray(array_to_draw(array));
    return data;
  } catch (const InvalidInput& error) {
    throw IoError(path.string(), fmt::format("is damaged or not complete ({})", error.what()));
  }
}

}  // namespace kappaflow
