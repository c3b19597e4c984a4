// Closed meshes: one tetrahedron and one cube in the formats that reconstructions write.
#include "tools/io/surface_mesh_file.h"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyDataWriter.h>
#include <vtkSTLWriter.h>

#include <array>

#include "core/errors.h"
#include "surface/mesh/mesh_measures.h"
#include "tests/tools/scratch.h"
#include "tools/io/vtk_arrays.h"
#include "tools/io/vtp_files.h"

namespace kappaflow {
namespace {

const std::vector<Vec3> kTetrahedron{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Triangle> kOutward{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

double volume_of(const MeshFrame& frame) {
  return area_and_volume(frame.surface.vertices, frame.surface.triangles).volume;
}

/// A cube with edges of 2: four quads, strips at the top and the bottom; with a time.
vtkSmartPointer<vtkPolyData> cube() {
  auto data = vtkSmartPointer<vtkPolyData>::New();
  std::vector<Vec3> corners(8);
  for (int i = 0; i < 8; ++i) corners[i] = Vec3(2 * (i & 1), i & 2, (i & 4) / 2);
  data->SetPoints(make_points(corners));
  vtkNew<vtkCellArray> quads, strips;
  quads->InsertNextCell({0, 1, 5, 4});
  quads->InsertNextCell({1, 3, 7, 5});
  quads->InsertNextCell({3, 2, 6, 7});
  quads->InsertNextCell({2, 0, 4, 6});
  strips->InsertNextCell({4, 5, 6, 7});
  strips->InsertNextCell({0, 2, 1, 3});
  data->SetPolys(quads);
  data->SetStrips(strips);
  vtkNew<vtkDoubleArray> time;
  time->SetName("time");
  time->InsertNextValue(1.5);
  data->GetFieldData()->AddArray(time);
  return data;
}

class MeshFrames : public Scratch {
 protected:
  static std::string obj(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
    std::string text;
    for (const Vec3& x : points) text += fmt::format("v {} {} {}\n", x.x(), x.y(), x.z());
    for (const auto& [a, b, c] : triangles) text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
    return text;
  }
  MeshFrame read_obj(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) const {
    return read_mesh_frame(file("a.obj", obj(points, triangles)));
  }
  std::string error(const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) const {
    const std::string message = message_of<InvalidInput>([&] { read_obj(points, triangles); });
    const std::string begin = (folder / "a.obj").string() + ": ";
    EXPECT_TRUE(message.starts_with(begin)) << message;
    return message.substr(begin.size());
  }
};

TEST_F(MeshFrames, PolygonsAndStripsAreTriangles) {
  const auto data = cube();
  write_vtp(folder / "a.vtp", *data);
  std::vector<std::filesystem::path> files{folder / "a.vtp"};
  for (const int version : {42, 51})
    for (const int type : {VTK_ASCII, VTK_BINARY}) {
      files.push_back(folder / fmt::format("a_{}_{}.vtk", version, type));
      vtkNew<vtkPolyDataWriter> writer;
      writer->SetFileName(files.back().c_str());
      writer->SetInputData(data);
      writer->SetFileType(type);
      writer->SetFileVersion(version);
      writer->Write();
    }
  for (const auto& path : files) {
    const MeshFrame frame = read_mesh_frame(path);
    EXPECT_EQ(frame.surface.vertices.size(), 8u) << path;
    EXPECT_EQ(frame.surface.triangles.size(), 12u) << path;
    EXPECT_DOUBLE_EQ(volume_of(frame), 8) << path;
    EXPECT_EQ(frame.time, 1.5) << path;
  }
}

TEST_F(MeshFrames, EqualPointsOfStlAreOne) {
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(make_points(kTetrahedron));
  data->SetPolys(make_triangles(kOutward));
  vtkNew<vtkSTLWriter> writer;
  writer->SetFileName((folder / "a.stl").c_str());
  writer->SetInputData(data);
  writer->SetFileTypeToBinary();
  writer->Write();
  const MeshFrame frame = read_mesh_frame(folder / "a.stl");
  EXPECT_EQ(frame.surface.vertices.size(), 4u);
  EXPECT_DOUBLE_EQ(volume_of(frame), 1.0 / 6);
  EXPECT_EQ(frame.time, std::nullopt);
}

TEST_F(MeshFrames, AMeshIsTurnedOutward) {
  std::vector<Triangle> inward = kOutward;
  for (Triangle& t : inward) std::swap(t[0], t[1]);
  for (const auto& triangles : {kOutward, inward})
    EXPECT_DOUBLE_EQ(volume_of(read_obj(kTetrahedron, triangles)), 1.0 / 6);
}

// Two tetrahedra that touch along the edge from 0 to 3: four triangles use it, two in each direction.
TEST_F(MeshFrames, BodiesMayTouchAlongAnEdge) {
  std::vector<Vec3> points = kTetrahedron;
  std::vector<Triangle> triangles = kOutward;
  points.insert(points.end(), {{-1, 0, 0}, {0, -1, 0}});
  for (Triangle t : kOutward) {
    for (int& v : t) v = v == 1 ? 4 : v == 2 ? 5 : v;
    triangles.push_back(t);
  }
  EXPECT_DOUBLE_EQ(volume_of(read_obj(points, triangles)), 2.0 / 6);
}

TEST_F(MeshFrames, AMeshThatIsNoSurfaceIsSaid) {
  const std::vector<Triangle> open{kOutward[0], kOutward[1], kOutward[2], {0, 1, 3}, {0, 3, 1}};
  EXPECT_EQ(
      error(kTetrahedron, open),
      "is not closed: an edge at (0, 0, 0) has no triangle on its other side, or one that is turned the "
      "other way");
  std::vector<Triangle> turned = kOutward;
  std::swap(turned[2][0], turned[2][1]);
  EXPECT_NE(error(kTetrahedron, turned).find("is not closed: an edge at ("), std::string::npos);
  EXPECT_EQ(error(kTetrahedron, {kOutward[0], kOutward[1], kOutward[2]}),
            "has 3 triangles; expected a closed surface of 4 or more");
  std::vector<Vec3> flat = kTetrahedron;
  flat[3] = {0.25, 0.25, 0};
  EXPECT_EQ(error(flat, kOutward), "encloses no volume");
  const auto nan = file("a.obj", "v 0 0 nan\n" + obj(kTetrahedron, kOutward));
  EXPECT_EQ(message_of<InvalidInput>([&] { read_mesh_frame(nan); }),
            nan.string() + ": has a point that is not finite");
}

TEST_F(MeshFrames, DamagedFilesAreSaid) {
  const auto damaged = [&](const char* name, const std::string& text) {
    const std::string message = message_of<IoError>([&] { read_mesh_frame(file(name, text)); });
    return message.substr((folder / name).string().size() + 2);
  };
  EXPECT_EQ(damaged("a.obj", "v 0 0\n").substr(0, 28), "is damaged or not complete (");
  const std::string head =
      "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\n";
  EXPECT_EQ(damaged("a.vtk", head + "POLYGONS 1 4\n3 0 1 3\n"),
            "is damaged or not complete (has a polygon with the corner 3 of 3 points)");
  EXPECT_EQ(damaged("a.vtk", head + "POLYGONS 1 4\n4 0 1 2\n"),
            "is damaged or not complete (has a polygon of 4 corners; 3 are left)");
  EXPECT_EQ(message_of<InvalidInput>([&] { read_mesh_frame(folder / "a.vtu"); }),
            (folder / "a.vtu").string() + ": unknown kind of mesh; expected .obj, .ply, .stl, .vtp or .vtk");
}

}  // namespace
}  // namespace kappaflow
