#include "tests/vtk_reader.h"

#include <vtkXMLPolyDataReader.h>

#include "core/errors.h"

namespace kappaflow {

vtkSmartPointer<vtkPolyData> read_vtp(const std::filesystem::path& path) {
  const auto reader = vtkSmartPointer<vtkXMLPolyDataReader>::New();
  if (!std::filesystem::exists(path)) throw IoError(path.string(), "is not there");
  reader->SetFileName(path.c_str());
  reader->Update();
  if (reader->GetErrorCode() != 0) throw IoError(path.string(), "is not a VTK PolyData file (.vtp)");
  return reader->GetOutput();
}

}  // namespace kappaflow
