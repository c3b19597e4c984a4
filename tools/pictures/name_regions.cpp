#include "tools/pictures/name_regions.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <initializer_list>

#include "tools/io/surface_file.h"

namespace kappaflow {
namespace {

/// The surface in the making.
class Regions {
 public:
  Regions(vtkPolyData& surface, vtkDataArray& names) : names_(names) {
    points_->DeepCopy(surface.GetPoints());
    normals_->DeepCopy(surface.GetPointData()->GetNormals());
    name_->SetName(names.GetName());
  }

  void add(const Triangle& corner) {
    const auto [a, b, c] = corner;
    if (name_of(a) == name_of(b) && name_of(b) == name_of(c)) {
      add_cell({a, b, c}, name_of(a));
      return;
    }
    const vtkIdType ab = middle({a, b}), bc = middle({b, c}), ca = middle({c, a}), centre = middle({a, b, c});
    add_cell({a, ab, centre, ca}, name_of(a));
    add_cell({b, bc, centre, ab}, name_of(b));
    add_cell({c, ca, centre, bc}, name_of(c));
  }

  vtkSmartPointer<vtkPolyData> take() {
    auto result = vtkSmartPointer<vtkPolyData>::New();
    result->SetPoints(points_);
    result->SetPolys(cells_);
    result->GetPointData()->SetNormals(normals_);
    result->GetCellData()->AddArray(name_);
    return result;
  }

 private:
  int name_of(vtkIdType vertex) const { return static_cast<int>(names_.GetComponent(vertex, 0)); }

  vtkIdType middle(std::initializer_list<vtkIdType> vertices) {
    Vec3 place = Vec3::Zero(), normal = Vec3::Zero();
    for (const vtkIdType v : vertices) {
      place += Vec3(points_->GetPoint(v)) / static_cast<double>(vertices.size());
      normal += Vec3(normals_->GetTuple3(v));
    }
    normals_->InsertNextTuple(normal.normalized().eval().data());
    return points_->InsertNextPoint(place.data());
  }

  void add_cell(std::initializer_list<vtkIdType> corners, int name) {
    cells_->InsertNextCell(static_cast<vtkIdType>(corners.size()), corners.begin());
    name_->InsertNextValue(name);
  }

  vtkDataArray& names_;
  vtkNew<vtkPoints> points_;
  vtkNew<vtkFloatArray> normals_;
  vtkNew<vtkCellArray> cells_;
  vtkNew<vtkIntArray> name_;
};

}  // namespace

vtkSmartPointer<vtkPolyData> name_regions(vtkPolyData& surface, const std::string& names) {
  Regions regions(surface, *surface.GetPointData()->GetArray(names.c_str()));
  for (const Triangle& triangle : triangles_of(surface)) regions.add(triangle);
  return regions.take();
}

}  // namespace kappaflow
