// Checkpoints of runs.
#include "tools/io/checkpoint.h"

#include "tests/fuzz/reader_fuzzer.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace kappaflow;
  const std::filesystem::path file = input_file("checkpoint.bin", bytes_of(data, size));
  value_or_error([&] { read_checkpoint(file); });
  return 0;
}
