// Particles, meshes and images in legacy VTK files.
#include "tools/io/legacy_vtk.h"

#include "tests/fuzz/reader_fuzzer.h"
#include "tools/io/input_frame.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kappaflow;
  const std::string_view bytes = bytes_of(data, size);
  const std::filesystem::path file = input_file("particles.vtk", bytes);
  value_or_error([&] { read_input_frame(file); });
  value_or_error([&] { parse_legacy_polygons(bytes); });
  value_or_error([&] { parse_legacy_image(bytes); });
  return 0;
}
