// Legacy VTK files: what VTK's own writer makes, and what its reader takes.
#include "tools/io/legacy_vtk.h"

#include <vtkBitArray.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkInformation.h>
#include <vtkInformationStringKey.h>
#include <vtkIntArray.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataWriter.h>
#include <vtkSignedCharArray.h>
#include <vtkStringArray.h>
#include <vtkTypeInt64Array.h>
#include <vtkTypeUInt64Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnsignedShortArray.h>
#include <vtkVariantArray.h>

#include "core/errors.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

constexpr vtkIdType kPoints = 3;
const std::vector<double> kVelocity{0.5, 0.25, -0.125, 1, 2, 3, -4, -5, -6};
const std::vector<double> kIds{7, 4, 300};

template <class Array>
vtkSmartPointer<Array> array_of(const char* name, const std::vector<double>& values, int components = 1) {
  auto result = vtkSmartPointer<Array>::New();
  result->SetName(name);
  result->SetNumberOfComponents(components);
  result->SetNumberOfTuples(static_cast<vtkIdType>(values.size()) / components);
  for (std::size_t i = 0; i < values.size(); ++i)
    result->SetComponent(static_cast<vtkIdType>(i) / components, static_cast<int>(i) % components, values[i]);
  return result;
}

vtkSmartPointer<vtkStringArray> texts(const char* name, const std::vector<std::string>& values) {
  auto result = vtkSmartPointer<vtkStringArray>::New();
  result->SetName(name);
  for (const std::string& value : values) result->InsertNextValue(value);
  return result;
}

/// Texts with what text files encode, none, and as long as it is said: binary files write lengths in four
/// ways.
std::vector<std::string> some_texts(std::size_t length) {
  return {"a blank, a\nline, 100 %", "", std::string(length, 'x')};
}

/// A point in every kind of array that VTK has, with what describes arrays: names of components, some of them
/// empty, and information.
vtkSmartPointer<vtkPolyData> three_points() {
  auto data = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> vertices;
  for (vtkIdType i = 0; i < kPoints; ++i) {
    points->InsertNextPoint(static_cast<double>(i), 0.5, -0.25);
    vertices->InsertNextCell(1, &i);
  }
  data->SetPoints(points);
  data->SetVerts(vertices);
  vtkPointData& arrays = *data->GetPointData();
  const auto scalars = array_of<vtkFloatArray>("scalars", {1, 2, 3});
  vtkNew<vtkLookupTable> colours;
  colours->SetNumberOfTableValues(4);
  colours->Build();
  scalars->SetLookupTable(colours);
  static vtkInformationStringKey* const key = vtkInformationStringKey::MakeKey("UNIT", "kappaflow");
  scalars->GetInformation()->Set(key, "a unit");
  arrays.SetScalars(scalars);
  const auto velocity = array_of<vtkFloatArray>("velocity", kVelocity, 3);
  velocity->SetComponentName(0, "X");
  velocity->SetComponentName(2, "last one");
  arrays.SetVectors(velocity);
  arrays.SetTensors(array_of<vtkDoubleArray>("six", std::vector<double>(18, 1.5), 6));
  arrays.SetTCoords(array_of<vtkFloatArray>("texture", std::vector<double>(6, 0.5), 2));
  arrays.SetGlobalIds(array_of<vtkIntArray>("global", {1, 2, 3}));
  arrays.SetPedigreeIds(texts("pedigree", some_texts(20000)));
  arrays.AddArray(texts("names", some_texts(100)));
  vtkNew<vtkVariantArray> variants;
  variants->SetName("variants");
  for (const vtkVariant& value : {vtkVariant(1.5), vtkVariant("a b"), vtkVariant("")})
    variants->InsertNextValue(value);
  arrays.AddArray(variants);
  arrays.AddArray(array_of<vtkBitArray>("bits", {1, 0, 1}));
  arrays.AddArray(array_of<vtkTypeInt64Array>("int64", {-1, 2, 3}));
  arrays.AddArray(array_of<vtkTypeUInt64Array>("uint64", {1, 2, 3}));
  arrays.AddArray(array_of<vtkSignedCharArray>("int8", {-1, 2, 3}));
  arrays.AddArray(array_of<vtkUnsignedCharArray>("uint8", {200, 2, 3}));
  arrays.AddArray(array_of<vtkUnsignedShortArray>("uint16", {40000, 2, 3}));
  arrays.AddArray(array_of<vtkDoubleArray>("five", std::vector<double>(15, 2.5), 5));
  arrays.AddArray(array_of<vtkIdTypeArray>("id", kIds));
  data->GetFieldData()->AddArray(texts("solver", {"some solver 2.1"}));
  data->GetFieldData()->AddArray(array_of<vtkDoubleArray>("TimeValue", {0.25}));
  return data;
}

std::vector<double> values_of(const PointData& data, const char* name, std::size_t components) {
  const PointArray* found = find_array(data.arrays, {name}, components);
  return found == nullptr ? std::vector<double>() : found->values;
}

void expect_three_points(const PointData& data) {
  ASSERT_EQ(data.position.size(), std::size_t{kPoints});
  EXPECT_EQ(data.position[2], Vec3(2, 0.5, -0.25));
  EXPECT_EQ(values_of(data, "velocity", 3), kVelocity);
  EXPECT_EQ(values_of(data, "id", 1), kIds);
}

/// The points as VTK's own writer puts them. type: VTK_ASCII or VTK_BINARY.
std::string written(int type) {
  vtkNew<vtkPolyDataWriter> writer;
  writer->SetInputData(three_points());
  writer->SetFileType(type);
  writer->WriteToOutputStringOn();
  writer->Write();
  return writer->GetOutputStdString();
}

TEST(LegacyVtk, ReadsEveryArrayThatVtkWrites) {
  for (const int type : {VTK_ASCII, VTK_BINARY}) {
    const PointData data = parse_legacy_vtk(written(type));
    expect_three_points(data);
    EXPECT_EQ(values_of(data, "scalars", 1), (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(values_of(data, "bits", 1), (std::vector<double>{1, 0, 1}));
    EXPECT_EQ(values_of(data, "int64", 1), (std::vector<double>{-1, 2, 3}));
    EXPECT_EQ(values_of(data, "uint64", 1), (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(values_of(data, "int8", 1), (std::vector<double>{-1, 2, 3}));
    EXPECT_EQ(values_of(data, "uint8", 1), (std::vector<double>{200, 2, 3}));
    EXPECT_EQ(values_of(data, "uint16", 1), (std::vector<double>{40000, 2, 3}));
    EXPECT_EQ(values_of(data, "six", 6), std::vector<double>(18, 1.5));
    EXPECT_EQ(values_of(data, "five", 5), std::vector<double>(15, 2.5));
    EXPECT_EQ(values_of(data, "global", 1), (std::vector<double>{1, 2, 3}));
    for (const char* text : {"names", "variants", "pedigree"})
      EXPECT_TRUE(values_of(data, text, 1).empty()) << "no numbers";
    ASSERT_EQ(data.fields.size(), 1u);
    EXPECT_EQ(data.fields[0].values, std::vector<double>{0.25});
  }
}

TEST(LegacyVtk, CutShortAnywhereIsAnErrorOrLessArrays) {
  for (const int type : {VTK_ASCII, VTK_BINARY}) {
    const std::string whole = written(type);
    for (std::size_t size = 0; size + 20 < whole.size(); size += size < 3000 ? 1 : 97) {
      try {
        EXPECT_EQ(find_array(parse_legacy_vtk(whole.substr(0, size)).arrays, {"id"}, 1), nullptr);
      } catch (const InvalidInput& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      }
    }
  }
}

/// A file of version 5.1 as text; `offsets` begins its second array of cells.
std::string with_cells(const std::string& before_offsets, const std::string& offsets) {
  return "# vtk DataFile Version 5.1\n\nascii\n\n dataset  PolyData\n\tpoints 3 Float\n0 .5 -.25 1 .5 "
         "-.25\n2 .5 "
         "-.25\nVertices 4 3" +
         before_offsets + offsets +
         " vtktypeint64\n0 1 2 3\n  CONNECTIVITY vtktypeint64\n0 1 2\n\nPoint_Data 3\nfield arrays "
         "1\nNULL_ARRAY\n"
         "SCALARS id int\n1\n lookup_table default\n7 4 300\nVectors velocity double\n.5 .25 -.125 1 2 3 -4 "
         "-5 -6\n";
}

TEST(LegacyVtk, KeywordsComeAfterAnyBlanksInAnyCase) {
  for (const char* before : {"\n", "\n\n", "\n  ", "\n\t", " \r\n"})
    for (const char* offsets : {"OFFSETS", "offsets", "Offsets"})
      expect_three_points(parse_legacy_vtk(with_cells(before, offsets)));
}

}  // namespace
}  // namespace kappaflow
