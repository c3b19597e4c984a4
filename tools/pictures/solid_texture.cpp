#include "tools/pictures/solid_texture.h"

#include <fmt/format.h>
#include <vtkImageReader2.h>
#include <vtkJPEGReader.h>
#include <vtkObject.h>
#include <vtkPNGReader.h>
#include <vtkPointData.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "core/errors.h"
#include "core/named.h"
#include "core/read_file.h"

namespace kappaflow {
namespace {

constexpr Named<SolidTexture::Kind> kPatterns[] = {{"checker", SolidTexture::Kind::checker},
                                                   {"stripes", SolidTexture::Kind::stripes},
                                                   {"grid", SolidTexture::Kind::grid}};

bool is_png(const std::filesystem::path& file) {
  return file.extension() == ".png";
}

std::uint32_t big_endian(std::string_view bytes) {
  std::uint32_t number = 0;
  for (const char byte : bytes.substr(0, 4)) number = number << 8 | static_cast<unsigned char>(byte);
  return number;
}

/// Whether all of its parts are there as they were written: VTK's reader crashes where they are not.
bool is_whole_png(std::string_view bytes) {
  constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n");
  if (!bytes.starts_with(kSignature)) return false;
  bytes.remove_prefix(kSignature.size());
  while (bytes.size() >= 12) {  // length, type, so many bytes, check sum of type and bytes
    const std::size_t length = big_endian(bytes);
    if (bytes.size() - 12 < length) return false;
    const std::string_view part = bytes.substr(4, 4 + length);
    const auto sum = crc32(0, reinterpret_cast<const Bytef*>(part.data()), static_cast<uInt>(part.size()));
    if (sum != big_endian(bytes.substr(8 + length))) return false;
    if (part.starts_with("IEND")) return true;
    bytes.remove_prefix(12 + length);
  }
  return false;
}

/// Red, green and blue with 8 bits, whatever the file has: grey, transparency (which is left out), 16 bits.
vtkSmartPointer<vtkImageData> rgb_image(vtkImageData& image) {
  const int* size = image.GetDimensions();
  const int channels = image.GetNumberOfScalarComponents();
  const double scale = image.GetScalarType() == VTK_UNSIGNED_SHORT ? 1.0 / 257 : 1;
  auto result = vtkSmartPointer<vtkImageData>::New();
  result->SetDimensions(size[0], size[1], 1);
  result->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  for (int y = 0; y < size[1]; ++y)
    for (int x = 0; x < size[0]; ++x)
      for (int c = 0; c < 3; ++c)
        result->SetScalarComponentFromDouble(
            x, y, 0, c, scale * image.GetScalarComponentAsDouble(x, y, 0, channels < 3 ? 0 : c));
  return result;
}

vtkSmartPointer<vtkImageData> read_image(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  vtkSmartPointer<vtkImageReader2> reader;
  if (is_png(file))
    reader = vtkSmartPointer<vtkPNGReader>::New();
  else
    reader = vtkSmartPointer<vtkJPEGReader>::New();
  reader->SetMemoryBuffer(bytes.data());
  reader->SetMemoryBufferLength(static_cast<vtkIdType>(bytes.size()));
  const bool is_right = is_png(file) ? is_whole_png(bytes) : bytes.starts_with("\xff\xd8\xff");
  vtkObject::GlobalWarningDisplayOff();  // VTK prints nothing of its own
  if (is_right) reader->Update();
  vtkObject::GlobalWarningDisplayOn();
  if (!is_right || reader->GetErrorCode() != 0 ||
      reader->GetOutput()->GetPointData()->GetScalars() == nullptr)
    throw IoError(file.string(), fmt::format("is not a picture in {}", is_png(file) ? "PNG" : "JPEG"));
  return rgb_image(*reader->GetOutput());
}

}  // namespace

bool is_texture(const std::string& name) {
  const std::string ending = std::filesystem::path(name).extension().string();
  return value_of(kPatterns, name) || ending == ".png" || ending == ".jpg" || ending == ".jpeg";
}

SolidTexture solid_texture(const std::string& name, const Bounds& box, TextureProjection projection) {
  if (const auto pattern = value_of(kPatterns, name)) return {*pattern, nullptr, box, projection};
  return {SolidTexture::Kind::image, read_image(name), box, projection};
}

}  // namespace kappaflow
