#include "tools/io/vtp_files.h"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>

#include "core/errors.h"
#include "tests/tools/scratch.h"
#include "tests/vtk_reader.h"
#include "tools/io/files.h"
#include "tools/io/surface_file.h"

namespace kappaflow {
namespace {

class DataFiles : public Scratch {
 protected:
  vtkSmartPointer<vtkPolyData> written_and_read(const vtkSmartPointer<vtkPolyData>& data) const {
    write_vtp(folder / "a.vtp", *data);
    return read_vtp(folder / "a.vtp");
  }
};

void expect_array(vtkDataSetAttributes& arrays, const char* name, int type, int components) {
  vtkDataArray* array = arrays.GetArray(name);
  ASSERT_NE(array, nullptr) << name;
  EXPECT_EQ(array->GetDataType(), type) << name;
  EXPECT_EQ(array->GetNumberOfComponents(), components) << name;
}

void expect_time(vtkPolyData& data, double time) {
  const auto* value = vtkDoubleArray::SafeDownCast(data.GetFieldData()->GetArray("TimeValue"));
  ASSERT_NE(value, nullptr);
  EXPECT_EQ(const_cast<vtkDoubleArray*>(value)->GetValue(0), time);
}

// Two triangles of a square; every number of a vertex differs.
struct Square {
  Square()
      : mesh(make_triangle_mesh({{0, 0, 1.0 / 3}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}})) {
    for (int v = 0; v < 4; ++v) {
      mesh.rest_position[v] += Vec3(0, 0, 10);
      state.normal.emplace_back(v, 0, 1);
      state.motion.velocity.emplace_back(0, v, 2);
      state.motion.confidence.push_back(0.25 * v);
      state.mean_curvature.push_back(1 + v);
      state.gaussian_curvature.push_back(2 + v);
      state.material_slip.push_back(3 + v);
      texture.emplace_back(0.1 * v, 0.5);
    }
    mesh.source = {4, 3, kUnknownSource, 4};
    mesh.unprojected[2] = 1;
  }
  vtkSmartPointer<vtkPolyData> data() const { return surface_data({0.16, mesh, state, checker, texture}); }

  TriangleMesh mesh;
  SurfaceState state;
  Checker checker{Vec3(0.1, 0.2, 0.3), 0.25};
  std::vector<Vec2> texture;
};

TEST_F(DataFiles, SurfaceHasTheArraysThatAProgramAdded) {
  Square square;
  square.mesh.add_array<double>("heat", Carry::interpolate, 0.0)[2] = 0.5;
  square.mesh.add_array<Vec3>("force", Carry::recompute, Vec3(1, 2, 3));
  square.mesh.add_array<int>("part", Carry::nearest, 7)[3] = 8;
  const auto data = written_and_read(square.data());
  vtkPointData& arrays = *data->GetPointData();
  expect_array(arrays, "heat", VTK_DOUBLE, 1);
  expect_array(arrays, "force", VTK_DOUBLE, 3);
  expect_array(arrays, "part", VTK_INT, 1);
  EXPECT_EQ(arrays.GetArray("heat")->GetComponent(2, 0), 0.5);
  EXPECT_EQ(arrays.GetArray("force")->GetComponent(1, 2), 3);
  EXPECT_EQ(arrays.GetArray("part")->GetComponent(3, 0), 8);
}

TEST_F(DataFiles, AnAddedArrayDoesNotReplaceTheFilesOwn) {
  Square square;
  square.mesh.add_array<double>("confidence", Carry::interpolate, 0.0);
  EXPECT_THROW(square.data(), InvalidInput);
}

TEST_F(DataFiles, SurfaceHasItsArraysAndTypes) {
  const auto data = written_and_read(Square().data());
  vtkPointData& arrays = *data->GetPointData();
  for (const char* name : {"mean_curvature", "gaussian_curvature", "confidence", "material_slip"})
    expect_array(arrays, name, VTK_FLOAT, 1);
  expect_array(arrays, "Normals", VTK_FLOAT, 3);
  expect_array(arrays, "velocity", VTK_FLOAT, 3);
  expect_array(arrays, "TCoords", VTK_FLOAT, 2);
  expect_array(arrays, "rest_position", VTK_DOUBLE, 3);
  expect_array(arrays, "checker", VTK_UNSIGNED_CHAR, 3);
  expect_array(arrays, "unprojected", VTK_UNSIGNED_CHAR, 1);
  expect_array(arrays, "source", VTK_INT, 1);
  expect_array(arrays, "id", VTK_TYPE_INT64, 1);
  EXPECT_EQ(arrays.GetNumberOfArrays(), 12);
  expect_time(*data, 0.16);
  EXPECT_EQ(arrays.GetNormals(), arrays.GetArray("Normals")) << "active";
  EXPECT_EQ(arrays.GetTCoords(), arrays.GetArray("TCoords")) << "active";
}

TEST_F(DataFiles, SurfaceKeepsItsValues) {
  const Square square;
  const auto data = written_and_read(square.data());
  vtkPointData& arrays = *data->GetPointData();
  const std::vector<Rgb> colours = checker_colours(square.mesh.rest_position, square.checker);
  ASSERT_EQ(data->GetNumberOfPoints(), 4);
  for (vtkIdType v = 0; v < 4; ++v) {
    EXPECT_EQ(Vec3(data->GetPoint(v)), square.mesh.position[v]) << "to the last bit";
    EXPECT_EQ(Vec3(arrays.GetArray("rest_position")->GetTuple3(v)), square.mesh.rest_position[v]);
    EXPECT_EQ(Vec3(arrays.GetArray("velocity")->GetTuple3(v)), square.state.motion.velocity[v]);
    EXPECT_EQ(arrays.GetArray("material_slip")->GetTuple1(v), 3.0 + static_cast<double>(v));
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(arrays.GetArray("checker")->GetComponent(v, c), colours[static_cast<std::size_t>(v)][c]);
    EXPECT_EQ(arrays.GetArray("source")->GetTuple1(v), square.mesh.source[v]);
    EXPECT_EQ(arrays.GetArray("unprojected")->GetTuple1(v), v == 2 ? 1 : 0);
  }
  ASSERT_EQ(data->GetNumberOfPolys(), 2);
  vtkIdType corners = 0;
  const vtkIdType* corner = nullptr;
  data->GetPolys()->GetCellAtId(1, corners, corner);
  EXPECT_EQ((std::vector<vtkIdType>(corner, corner + corners)), (std::vector<vtkIdType>{0, 2, 3}));
}

TEST_F(DataFiles, SlipAndSourceAreLeftOutWhereUnknown) {
  Square square;
  square.state.material_slip.clear();
  square.mesh.source.assign(4, kUnknownSource);
  EXPECT_EQ(square.data()->GetPointData()->GetArray("material_slip"), nullptr);
  EXPECT_EQ(square.data()->GetPointData()->GetArray("source"), nullptr);
}

TEST_F(DataFiles, ColoursAndTextureMayBeLeftOut) {
  const Square square;
  const auto data = written_and_read(surface_data({0.16, square.mesh, square.state}));
  EXPECT_EQ(data->GetPointData()->GetArray("checker"), nullptr);
  EXPECT_EQ(data->GetPointData()->GetArray("TCoords"), nullptr);
  EXPECT_EQ(data->GetPointData()->GetNumberOfArrays(), 10);
}

TEST_F(DataFiles, FileIsInlineCompressedBinary) {
  write_vtp(folder / "a.vtp", *Square().data());
  const std::string text = bytes_of(folder / "a.vtp");
  EXPECT_NE(text.find("format=\"binary\""), std::string::npos);
  EXPECT_EQ(text.find("format=\"appended\""), std::string::npos);
  EXPECT_EQ(text.find("format=\"ascii\""), std::string::npos);
  EXPECT_EQ(text.find("<AppendedData"), std::string::npos);
  EXPECT_NE(text.find("compressor=\"vtkZLibDataCompressor\""), std::string::npos);
}

TEST_F(DataFiles, ParticlesAreVerticesWithTheirArrays) {
  Particles particles{0.5, {3, 7}, {{1, 2, 3}, {4, 5, 6}}, {{0.5, 0, 0}, {0, 0.25, 0}}};
  const std::vector<float> density{1000, 1001}, pressure{0, 250}, temperature{290, 310};
  const std::vector<int> source{2, 0};
  const std::vector<double> weight{1, 1.0 / 3};
  const auto data =
      written_and_read(particle_data({particles, density, pressure, source, temperature}, weight, 0.1));
  vtkPointData& arrays = *data->GetPointData();
  expect_array(arrays, "velocity", VTK_FLOAT, 3);
  expect_array(arrays, "density", VTK_FLOAT, 1);
  expect_array(arrays, "pressure", VTK_FLOAT, 1);
  expect_array(arrays, "temperature", VTK_FLOAT, 1);
  expect_array(arrays, "source", VTK_INT, 1);
  expect_array(arrays, "weight", VTK_DOUBLE, 1);
  expect_array(arrays, "sigma", VTK_DOUBLE, 1);
  EXPECT_EQ(arrays.GetArray("id")->GetDataTypeSize(), 8);
  EXPECT_EQ(arrays.GetArray("id")->GetTuple1(1), 7);
  EXPECT_EQ(arrays.GetArray("source")->GetTuple1(0), 2);
  EXPECT_EQ(arrays.GetArray("weight")->GetTuple1(1), 1.0 / 3);
  EXPECT_EQ(arrays.GetArray("pressure")->GetTuple1(1), 250);
  EXPECT_EQ(arrays.GetArray("temperature")->GetTuple1(1), 310);
  EXPECT_EQ(Vec3(data->GetPoint(1)), Vec3(4, 5, 6));
  EXPECT_EQ(data->GetNumberOfVerts(), 2);
  expect_time(*data, 0.5);
}

TEST_F(DataFiles, BoundaryJoinsTheWalls) {
  const TriangleSurface wall{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const auto data = written_and_read(boundary_data(std::vector<TriangleSurface>{wall, wall}));
  EXPECT_EQ(data->GetNumberOfPoints(), 6);
  ASSERT_EQ(data->GetNumberOfPolys(), 2);
  EXPECT_EQ(data->GetCellData()->GetArray("wall")->GetTuple1(1), 1);
  const auto read_by_ours = read_surface(folder / "a.vtp");
  ASSERT_NE(read_by_ours->GetCellData()->GetArray("wall"), nullptr);
  EXPECT_EQ(read_by_ours->GetCellData()->GetArray("wall")->GetTuple1(1), 1);
}

TEST_F(DataFiles, SurfacesAreReadToBeDrawn) {
  const Square square;
  write_vtp(folder / "a.vtp", *square.data());
  const auto data = read_surface(folder / "a.vtp");
  ASSERT_EQ(data->GetNumberOfPoints(), 4);
  ASSERT_EQ(data->GetNumberOfPolys(), 2);
  vtkIdType corners = 0;
  const vtkIdType* corner = nullptr;
  data->GetPolys()->GetCellAtId(1, corners, corner);
  EXPECT_EQ((std::vector<vtkIdType>(corner, corner + corners)), (std::vector<vtkIdType>{0, 2, 3}));
  vtkPointData& arrays = *data->GetPointData();
  EXPECT_EQ(arrays.GetNumberOfArrays(), 12);
  expect_array(arrays, "checker", VTK_UNSIGNED_CHAR, 3);
  expect_array(arrays, "source", VTK_INT, 1);
  EXPECT_EQ(arrays.GetNormals(), arrays.GetArray("Normals")) << "active";
  expect_time(*data, 0.16);
  EXPECT_EQ(Vec3(data->GetFieldData()->GetArray("checker_origin")->GetTuple3(0)), square.checker.origin);
  EXPECT_EQ(data->GetFieldData()->GetArray("checker_edge")->GetTuple1(0), square.checker.edge);
  const std::vector<Rgb> colours = checker_colours(square.mesh.rest_position, square.checker);
  for (vtkIdType v = 0; v < 4; ++v) {
    EXPECT_EQ(Vec3(data->GetPoint(v)), square.mesh.position[v]);
    EXPECT_EQ(Vec3(arrays.GetArray("velocity")->GetTuple3(v)), square.state.motion.velocity[v]);
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(arrays.GetArray("checker")->GetComponent(v, c), colours[static_cast<std::size_t>(v)][c]);
    EXPECT_EQ(arrays.GetArray("source")->GetTuple1(v), square.mesh.source[v]);
  }
}

TEST_F(DataFiles, RubbishIsAnIoErrorAndPrintsNothing) {
  const auto rubbish = file("a.vtp", "not XML at all");
  const auto cut =
      file("b.vtp", "<?xml version=\"1.0\"?><VTKFile type=\"PolyData\" version=\"0.1\"><PolyData>");
  testing::internal::CaptureStderr();
  EXPECT_THROW(read_surface(rubbish), IoError);
  EXPECT_THROW(read_surface(cut), IoError);
  EXPECT_THROW(read_surface(folder / "none.vtp"), IoError);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

/// A square of two triangles as text, with these corners, offsets and first coordinate.
std::string square_text(const std::string& corners, const std::string& offsets, const std::string& x = "0") {
  return fmt::format(
      R"(<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="4" NumberOfPolys="2">
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{} 0 0 1 0 0 1 1 0 0 1 0</DataArray></Points>
<Polys><DataArray type="Int64" Name="connectivity" format="ascii">{}</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">{}</DataArray></Polys></Piece></PolyData></VTKFile>)",
      x, corners, offsets);
}

TEST_F(DataFiles, SurfacesThatCannotBeDrawnAreOneLine) {
  const auto message = [&](const std::string& text) {
    const auto path = file("a.vtp", text);
    return message_of<IoError>([&] { read_surface(path); }).substr(path.string().size());
  };
  const std::string begin = ": is damaged or not complete (", end = ")";
  EXPECT_EQ(read_surface(file("a.vtp", square_text("0 1 2 0 2 3", "3 6")))->GetNumberOfPolys(), 2);
  EXPECT_EQ(message(square_text("0 1 2 0 2 4", "3 6")),
            begin + "has a polygon with the corner 4 of 4 points" + end);
  EXPECT_EQ(message(square_text("0 1 2 0 2 -1", "3 6")),
            begin + "has a polygon with the corner -1 of 4 points" + end);
  EXPECT_EQ(message(square_text("0 1 2 0 2 nan", "3 6")),
            begin + "has a polygon with the corner nan of 4 points" + end);
  EXPECT_EQ(message(square_text("0 1 2 3", "4")), begin + "polygon 0 is no triangle" + end);
  EXPECT_EQ(message(square_text("0 1 2 0 2", "3 6")),
            begin + "has a polygon that ends at 6 of 5 corners" + end);
  std::string with_array = square_text("0 1 2 0 2 3", "3 6");
  with_array.insert(
      with_array.find("<Polys>"),
      R"(<CellData><DataArray type="Int32" Name="wall" format="ascii">0 1 1</DataArray></CellData>)");
  EXPECT_EQ(message(with_array), begin + "array \"wall\" has 3 numbers for 2 triangles" + end);
  EXPECT_EQ(message(square_text("0 1 2 0 2 3", "3 6", "inf")), begin + "vertex 0 is nowhere" + end);
}

// Each byte in turn is wrong, or the file ends there: an error, or a surface that can be drawn.
TEST_F(DataFiles, DamagedSurfacesAreErrorsOrSurfaces) {
  write_vtp(folder / "a.vtp", *Square().data());
  const std::string whole = bytes_of(folder / "a.vtp");
  testing::internal::CaptureStderr();
  int refused = 0;
  for (std::size_t byte = 0; byte < whole.size(); ++byte) {
    std::string damaged = whole;
    damaged[byte] = static_cast<char>(damaged[byte] ^ 4);
    try {
      const auto data = read_surface(file("b.vtp", damaged));
      EXPECT_LE(data->GetPolys()->GetMaxCellSize(), 3);
      double bounds[6];
      data->GetBounds(bounds);
    } catch (const IoError&) {
      ++refused;
    }
    if (byte + 10 < whole.size()) {  // what closes the last element
      EXPECT_THROW(read_surface(file("b.vtp", whole.substr(0, byte))), IoError) << byte;
    }
  }
  EXPECT_GT(refused, static_cast<int>(whole.size()) / 2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace kappaflow
