// Pictures as tests look at them.
#pragma once

#include <vtkImageData.h>
#include <vtkPNGReader.h>
#include <vtkSmartPointer.h>

#include <filesystem>

namespace kappaflow {

/// An image's bytes, red green blue, line by line from below.
struct Image {
  explicit Image(const std::filesystem::path& file) {
    reader->SetFileName(file.c_str());
    reader->Update();
    data = reader->GetOutput();
  }
  int at(int x, int y, int channel) const {
    return static_cast<int>(data->GetScalarComponentAsDouble(x, y, 0, channel));
  }
  vtkSmartPointer<vtkPNGReader> reader = vtkSmartPointer<vtkPNGReader>::New();
  vtkImageData* data;
};

/// The share of the picture's pixels that are clearly blue, as the checker is and walls are not.
inline double blue_share(const Image& image) {
  const int* dims = image.data->GetDimensions();
  int blue = 0;
  for (int y = 0; y < dims[1]; ++y)
    for (int x = 0; x < dims[0]; ++x) blue += image.at(x, y, 2) > image.at(x, y, 0) + 25;
  return blue / (1.0 * dims[0] * dims[1]);
}

}  // namespace kappaflow
