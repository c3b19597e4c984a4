// vtp FILE...: says of each surface file how many pieces it has, and whether it is sound: closed, its numbers
// finite, its arrays there.
#include <vtkCell.h>
#include <vtkDataArray.h>
#include <vtkFeatureEdges.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataConnectivityFilter.h>
#include <vtkSmartPointer.h>
#include <vtkXMLPolyDataReader.h>

#include <cmath>
#include <cstdio>

namespace {

long open_edges(vtkPolyData* surface) {
  auto edges = vtkSmartPointer<vtkFeatureEdges>::New();
  edges->SetInputData(surface);
  edges->FeatureEdgesOff();
  edges->Update();
  return static_cast<long>(edges->GetOutput()->GetNumberOfCells());
}

int pieces(vtkPolyData* surface) {
  auto connectivity = vtkSmartPointer<vtkPolyDataConnectivityFilter>::New();
  connectivity->SetInputData(surface);
  connectivity->SetExtractionModeToAllRegions();
  connectivity->Update();
  return connectivity->GetNumberOfExtractedRegions();
}

bool is_sound(vtkPolyData* surface) {
  const vtkIdType n = surface->GetNumberOfPoints();
  if (n < 100 || surface->GetNumberOfPolys() < n || open_edges(surface) > 0) return false;
  for (const char* name :
       {"Normals", "velocity", "mean_curvature", "gaussian_curvature", "confidence", "rest_position", "id"}) {
    vtkDataArray* array = surface->GetPointData()->GetArray(name);
    if (!array || array->GetNumberOfTuples() != n) return false;
    for (vtkIdType v = 0; v < n; ++v)
      for (int c = 0; c < array->GetNumberOfComponents(); ++c)
        if (!std::isfinite(array->GetComponent(v, c))) return false;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    auto reader = vtkSmartPointer<vtkXMLPolyDataReader>::New();
    reader->SetFileName(argv[k]);
    reader->Update();
    vtkPolyData* surface = reader->GetOutput();
    std::printf("%s: %d piece(s), %s\n", argv[k], pieces(surface), is_sound(surface) ? "sound" : "DAMAGED");
  }
}
