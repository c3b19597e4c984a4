// Mesh files: the beginning says which of the three formats.
#include "scenes/mesh_file.h"
#include "tests/fuzz/reader_fuzzer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kappaflow;
  const std::string_view bytes = bytes_of(data, size);
  const bool obj = bytes.starts_with("v ") || bytes.starts_with("#");
  const std::filesystem::path file = input_file(bytes.starts_with("ply") ? "mesh.ply"
                                                : obj                    ? "mesh.obj"
                                                                         : "mesh.stl",
                                                bytes);
  value_or_error([&] { read_closed_mesh(file, {"scene.toml", 1, 1}); });
  return 0;
}
