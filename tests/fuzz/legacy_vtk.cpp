// Particles in legacy VTK files.
#include "tests/fuzz/reader_fuzzer.h"
#include "tools/io/input_frame.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kappaflow;
  const std::string_view bytes = bytes_of(data, size);
  const std::filesystem::path file = input_file("particles.vtk", bytes);
  value_or_error([&] { read_input_frame(file); });
  return 0;
}
