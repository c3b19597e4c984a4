// Particles, surfaces, images and lists of pieces in VTK XML files, of other programs and our own.
#include "tools/io/vtk_xml.h"

#include "tests/fuzz/reader_fuzzer.h"
#include "tools/io/image_pieces.h"
#include "tools/io/input_frame.h"
#include "tools/io/particle_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kappaflow;
  const std::string_view bytes = bytes_of(data, size);
  const bool grid = bytes.find("UnstructuredGrid") != std::string_view::npos;
  const std::filesystem::path file = input_file(grid ? "particles.vtu" : "particles.vtp", bytes);
  value_or_error([&] { read_input_frame(file); });
  if (!grid) value_or_error([&] { read_particle_file(file); });
  value_or_error([&] { parse_vtk_surface(bytes); });
  const std::vector<std::filesystem::path> images(2, input_file("image.vti", bytes));
  value_or_error([&] { read_image(images); });
  value_or_error([&] { parse_vtk_image_list(bytes); });
  value_or_error([&] { parse_vtk_pieces(bytes, grid ? "UnstructuredGrid" : "PolyData"); });
  return 0;
}
