// Images that solvers on grids might write, by VTK's own writers and byte by byte.
#pragma once

#include <fmt/format.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <filesystem>
#include <string>

namespace kappaflow {

/// 5 x 6 x 7 points from (1, 2, 3) on, 0.5, 0.25 and 0.125 apart. Each array has a number for each tuple and
/// component that no other has.
inline vtkSmartPointer<vtkImageData> small_image() {
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(5, 6, 7);
  image->SetOrigin(1, 2, 3);
  image->SetSpacing(0.5, 0.25, 0.125);
  return image;
}

template <class Array>
void add_array(vtkDataSetAttributes& to, const char* name, vtkIdType tuples, int components) {
  vtkNew<Array> array;
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(tuples);
  for (vtkIdType i = 0; i < tuples; ++i)
    for (int c = 0; c < components; ++c)
      array->SetComponent(i, c, 0.25 * static_cast<double>(i) - 8 - 1000 * c);
  to.AddArray(array);
}

inline void add_time(vtkImageData& image, double time) {
  vtkNew<vtkDoubleArray> array;
  array->SetName("TimeValue");
  array->InsertNextValue(time);
  image.GetFieldData()->AddArray(array);
}

/// Text of an image of 4 x 4 x 4 points with the attributes of ImageData, of the first 64 `values`.
inline std::string vti_text(const std::string& attributes, const std::string& arrays,
                            const std::string& field_data = "") {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "<ImageData {}>{}<Piece Extent=\"0 3 0 3 0 3\">{}</Piece></ImageData>\n</VTKFile>\n",
      attributes, field_data, arrays);
}

inline const std::string kUnitLattice = "WholeExtent=\"0 3 0 3 0 3\" Origin=\"0 0 0\" Spacing=\"1 1 1\"";

/// An array of points of as many equal numbers, or with another number in the place `odd`.
inline std::string vti_array(const std::string& name, int numbers = 64, int components = 1,
                             const std::string& other = "", int odd = -1) {
  std::string values;
  for (int i = 0; i < numbers; ++i) values += i == odd ? other + " " : "0.5 ";
  return fmt::format(
      "<DataArray type=\"Float32\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"ascii\">{}</DataArray>",
      name, components, values);
}

inline std::string vti_points(const std::string& arrays) {
  return "<PointData>" + arrays + "</PointData>";
}

inline std::string vti_time(double time) {
  return fmt::format(
      "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
      "format=\"ascii\">{}</DataArray></FieldData>",
      time);
}

}  // namespace kappaflow
