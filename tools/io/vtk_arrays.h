// VTK's arrays, points and triangles from ours.
#pragma once

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>

#include <span>
#include <type_traits>

#include "core/types.h"

namespace kappaflow {

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
inline vtkSmartPointer<vtkPoints> make_points(std::span<const Vec3> positions) {
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetData(make_array<vtkDoubleArray>("Points", 3, positions));
  return points;
}

inline vtkSmartPointer<vtkCellArray> make_triangles(std::span<const Triangle> triangles) {
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->AllocateExact(static_cast<vtkIdType>(triangles.size()),
                       3 * static_cast<vtkIdType>(triangles.size()));
  for (const Triangle& t : triangles) cells->InsertNextCell({t[0], t[1], t[2]});
  return cells;
}

}  // namespace kappaflow
