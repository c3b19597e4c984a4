// glTF files, read back by VTK.
#include "tools/io/glb.h"

#include <vtkCell.h>
#include <vtkCompositeDataIterator.h>
#include <vtkDataArray.h>
#include <vtkGLTFReader.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtk_jsoncpp.h>

#include <Eigen/Geometry>
#include <cstring>

#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

const std::vector<Vec3> kPosition{{0, 0, 0}, {1.5, 0, 0}, {0, 1, 0}, {0.1, 0.2, -2}};
const std::vector<Vec3> kNormal{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.6, 0.8, 0}};
const std::vector<Vec2> kTexture{{0, 0}, {1, 0}, {0, 1}, {0.25, 0.75}};
const std::vector<Rgb> kColour{{0, 0, 0}, {255, 255, 255}, {188, 10, 55}, {255, 0, 0}};
const std::vector<Triangle> kTriangles{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

class Glb : public Scratch {
 protected:
  vtkSmartPointer<vtkPolyData> read(const std::string& bytes) const {
    vtkNew<vtkGLTFReader> reader;
    reader->SetFileName(file("a.glb", bytes).c_str());
    reader->Update();
    const vtkSmartPointer<vtkCompositeDataIterator> leaf =
        vtk::TakeSmartPointer(reader->GetOutput()->NewIterator());
    return vtkPolyData::SafeDownCast(leaf->GetCurrentDataObject());
  }
};

double component(vtkPolyData& mesh, const char* array, std::size_t vertex, int c) {
  vtkDataArray* const found = mesh.GetPointData()->GetArray(array);
  return found != nullptr ? found->GetComponent(static_cast<vtkIdType>(vertex), c) : -100;
}

TEST_F(Glb, HoldsTheMesh) {
  const auto mesh = read(glb_bytes({kPosition, kNormal, kTexture, kColour, kTriangles}));
  ASSERT_TRUE(mesh);
  ASSERT_EQ(mesh->GetNumberOfPoints(), 4);
  ASSERT_EQ(mesh->GetNumberOfCells(), 4);
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_LT((Vec3(mesh->GetPoint(static_cast<vtkIdType>(v))) - kPosition[v]).norm(), 1e-6);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(component(*mesh, "NORMAL", v, c), kNormal[v][c], 1e-6);
    EXPECT_NEAR(component(*mesh, "TEXCOORD_0", v, 0), kTexture[v][0], 1e-6);
    EXPECT_NEAR(component(*mesh, "TEXCOORD_0", v, 1), 1 - kTexture[v][1], 1e-6);
  }
  for (std::size_t t = 0; t < 4; ++t)
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(mesh->GetCell(static_cast<vtkIdType>(t))->GetPointId(c), kTriangles[t][c]);
}

/// IEC 61966-2-1: sRGB 188 is 0.5029 of the light of 255, and 10, below the bend, is 10/255/12.92.
TEST_F(Glb, ColoursAreLinear) {
  const auto mesh = read(glb_bytes({kPosition, kNormal, kTexture, kColour, kTriangles}));
  ASSERT_TRUE(mesh);
  const double whole = component(*mesh, "COLOR_0", 1, 0);
  EXPECT_GT(whole, 0);
  EXPECT_NEAR(component(*mesh, "COLOR_0", 2, 0) / whole, 0.5029, 1e-4);
  EXPECT_NEAR(component(*mesh, "COLOR_0", 2, 1) / whole, 10 / 255.0 / 12.92, 1e-5);
  EXPECT_EQ(component(*mesh, "COLOR_0", 0, 2), 0);
}

/// Two triangles that disagree about the texture at vertex 1: it is two vertices in the file.
TEST_F(Glb, HoldsArraysAndATextureWithoutSeams) {
  std::vector<Vec2> texture = kTexture;
  texture.emplace_back(0.5, 0.125);
  const std::vector<Triangle> corners{{0, 2, 1}, {0, 4, 3}, {1, 2, 3}, {2, 0, 3}};
  const std::vector<PointArray> arrays{
      {"rest", 3, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}, NumberType::float64},
      {"id", 1, {7, 8, 9, 12}, NumberType::int64}};
  const auto mesh = read(glb_bytes({kPosition, kNormal, texture, kColour, kTriangles, corners, arrays}));
  ASSERT_TRUE(mesh);
  ASSERT_EQ(mesh->GetNumberOfPoints(), 5);
  for (std::size_t v = 0; v < 5; ++v) {
    const std::size_t of = v < 4 ? v : 1;
    EXPECT_LT((Vec3(mesh->GetPoint(static_cast<vtkIdType>(v))) - kPosition[of]).norm(), 1e-6);
    EXPECT_EQ(component(*mesh, "_ID", v, 0), arrays[1].values[of]);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(component(*mesh, "_REST", v, c), arrays[0].values[3 * of + c]);
  }
  EXPECT_EQ(component(*mesh, "TEXCOORD_0", 4, 1), 0.875);
  for (std::size_t t = 0; t < 4; ++t)
    for (int c = 0; c < 3; ++c)
      EXPECT_EQ(mesh->GetCell(static_cast<vtkIdType>(t))->GetPointId(c), corners[t][c]);
}

// glTF has y up: the node turns z there.
TEST_F(Glb, AMeshWithZUpIsTurned) {
  const std::string bytes = glb_bytes({kPosition, kNormal, kTexture, kColour, kTriangles, {}, {}, true});
  Json::Value json;
  std::uint32_t size = 0;
  std::memcpy(&size, bytes.data() + 12, sizeof size);
  ASSERT_TRUE(Json::Reader().parse(bytes.substr(20, size), json));
  const Json::Value& q = json["nodes"][0]["rotation"];
  const Eigen::Quaterniond rotation(q[3].asDouble(), q[0].asDouble(), q[1].asDouble(), q[2].asDouble());
  EXPECT_LT((rotation * Vec3(1, 2, 3) - Vec3(1, 3, -2)).norm(), 1e-12);
}

TEST_F(Glb, ChunksAndLengthsAreThoseOfTheFile) {
  for (const bool empty : {false, true}) {
    const std::string bytes =
        empty ? glb_bytes({}) : glb_bytes({kPosition, kNormal, kTexture, kColour, kTriangles});
    const auto number = [&](std::size_t at) {
      std::uint32_t value = 0;
      std::memcpy(&value, bytes.data() + at, sizeof value);
      return value;
    };
    EXPECT_EQ(bytes.substr(0, 4), "glTF");
    EXPECT_EQ(number(8), bytes.size());
    const std::uint32_t json_size = number(12);
    EXPECT_EQ(json_size % 4, 0u);
    Json::Value json;
    ASSERT_TRUE(Json::Reader().parse(bytes.substr(20, json_size), json)) << bytes.substr(20, json_size);
    EXPECT_EQ(json["asset"]["version"].asString(), "2.0");
    EXPECT_EQ(json.isMember("meshes"), !empty);
    const std::size_t arrays = 20 + json_size;
    if (empty) {
      EXPECT_EQ(arrays, bytes.size());
      continue;
    }
    EXPECT_EQ(number(arrays), json["buffers"][0]["byteLength"].asUInt());
    EXPECT_EQ(arrays + 8 + number(arrays), bytes.size());
    EXPECT_EQ(json["accessors"][0]["min"][2].asDouble(), -2);
    EXPECT_EQ(json["accessors"][0]["max"][0].asDouble(), 1.5);
  }
}

}  // namespace
}  // namespace kappaflow
