// Scene files.
#include "scenes/prepared_scene.h"
#include "tests/fuzz/reader_fuzzer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kappaflow;
  const std::string_view bytes = bytes_of(data, size);
  const std::filesystem::path file = input_file("scene.toml", bytes);
  value_or_error([&] { prepare(load_scene(file)); });
  return 0;
}
