#include "tools/io/vtp_files.h"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCommand.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <array>

#include "core/errors.h"
#include "surface/field/particle_weights.h"
#include "tools/io/files.h"
#include "tools/io/vtk_arrays.h"
#include "tools/io/zlib_compressor.h"

namespace kappaflow {
namespace {

void set_time(vtkPolyData& data, double time) {
  data.GetFieldData()->AddArray(
      make_array<vtkDoubleArray>("TimeValue", 1, 1, [&](std::size_t) { return time; }));
}

void add_checker(vtkPolyData& data, std::span<const Vec3> rest_position, const Checker& checker) {
  data.GetPointData()->AddArray(
      make_array<vtkUnsignedCharArray>("checker", 3, checker_colours(rest_position, checker)));
  vtkFieldData& fields = *data.GetFieldData();
  fields.AddArray(make_array<vtkDoubleArray>("checker_origin", 3, std::array{checker.origin}));
  fields.AddArray(make_array<vtkDoubleArray>("checker_edge", 1, std::array{checker.edge}));
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

}  // namespace

vtkSmartPointer<vtkPolyData> particle_data(const ParticleFrame& frame, std::span<const double> weight,
                                           double sigma) {
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
  if (!frame.temperature.empty()) arrays.AddArray(make_array("temperature", 1, frame.temperature));
  if (!frame.source.empty()) arrays.AddArray(make_array<vtkIntArray>("source", 1, frame.source));
  if (!weight.empty()) {
    arrays.AddArray(make_array<vtkDoubleArray>("weight", 1, weight));
    arrays.AddArray(
        make_array<vtkDoubleArray>("sigma", 1, support_radii(particles.size(), sigma, particles.scale)));
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
  if (!frame.texture_coordinates.empty())
    arrays.SetTCoords(make_array("TCoords", 2, frame.texture_coordinates));
  arrays.AddArray(make_array("velocity", 3, state.motion.velocity));
  arrays.AddArray(make_array("mean_curvature", 1, state.mean_curvature));
  arrays.AddArray(make_array("gaussian_curvature", 1, state.gaussian_curvature));
  arrays.AddArray(make_array("confidence", 1, state.motion.confidence));
  arrays.AddArray(make_array<vtkDoubleArray>("rest_position", 3, frame.mesh.rest_position));
  if (has_sources(frame.mesh)) arrays.AddArray(make_array<vtkIntArray>("source", 1, frame.mesh.source));
  arrays.AddArray(make_array<vtkTypeInt64Array>("id", 1, frame.mesh.id));
  if (frame.checker) add_checker(*data, frame.mesh.rest_position, *frame.checker);
  if (!state.material_slip.empty()) arrays.AddArray(make_array("material_slip", 1, state.material_slip));
  arrays.AddArray(make_array<vtkUnsignedCharArray>("unprojected", 1, frame.mesh.unprojected));
  for (const VertexArray& array : frame.mesh.added) {
    if (arrays.HasArray(array.name.c_str()) != 0)
      throw InvalidInput(fmt::format("surface files have an array '{}' of their own", array.name));
    std::visit([&](const auto& of) { arrays.AddArray(make_added_array(array.name, of.values)); }, array.data);
  }
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

std::string pvtp_text(vtkPolyData& like, std::span<const std::string> pieces) {
  std::string arrays;
  vtkPointData& data = *like.GetPointData();
  const auto type_of = [](vtkDataArray& array) {
    const char* const kind = array.GetDataType() == VTK_FLOAT || array.GetDataType() == VTK_DOUBLE ? "Float"
                             : array.GetDataTypeMin() < 0                                          ? "Int"
                                                                                                   : "UInt";
    return fmt::format("{}{}", kind, 8 * array.GetDataTypeSize());
  };
  for (int a = 0; a < data.GetNumberOfArrays(); ++a)
    arrays += fmt::format("      <PDataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"/>\n",
                          type_of(*data.GetArray(a)), data.GetArray(a)->GetName(),
                          data.GetArray(a)->GetNumberOfComponents());
  std::string sources;
  for (const std::string& piece : pieces) sources += fmt::format("    <Piece Source=\"{}\"/>\n", piece);
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PPolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <PPolyData GhostLevel=\"0\">\n    <PPointData>\n{}    </PPointData>\n"
      "    <PPoints>\n      <PDataArray type=\"{}\" Name=\"Points\" NumberOfComponents=\"3\"/>\n    "
      "</PPoints>\n{}  </PPolyData>\n</VTKFile>\n",
      arrays, type_of(*like.GetPoints()->GetData()), sources);
}

void write_vtp(const std::filesystem::path& path, vtkPolyData& data) {
  auto writer = vtkSmartPointer<vtkXMLPolyDataWriter>::New();
  auto errors = vtkSmartPointer<ErrorListener>::New();
  writer->AddObserver(vtkCommand::ErrorEvent, errors);
  writer->SetInputData(&data);
  writer->SetDataModeToBinary();  // VTK's default, appended data, is not well-formed XML: ParaView 5.11
                                  // rejects it
  writer->SetCompressor(vtkNew<ZLibCompressor>());
  writer->WriteToOutputStringOn();
  if (writer->Write() == 0 || errors->failed) throw IoError(path.string(), "VTK cannot encode the data");
  write_file(path, writer->GetOutputString());
}

}  // namespace kappaflow
