// What the fuzzers have in common.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/errors.h"

namespace kappaflow {

/// What libFuzzer hands over.
inline std::string_view bytes_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// The input as a file for readers that take a path, in the folder for temporary files; it is overwritten by
/// the next of that name.
inline std::filesystem::path input_file(std::string_view name, std::string_view bytes) {
  static const struct Folder {
    Folder() {
      if (mkdtemp(path.data()) == nullptr) throw std::runtime_error("no folder " + path);
    }
    ~Folder() { std::filesystem::remove_all(path); }
    std::string path = std::filesystem::temp_directory_path() / "kappaflow-fuzz-XXXXXX";
  } folder;
  const std::filesystem::path file = std::filesystem::path(folder.path) / name;
  std::ofstream(file, std::ios::binary) << bytes;
  return file;
}

/// Calls `read`, which may refuse its input by an Error of one line. Anything else that it throws ends the
/// fuzzer, as do crashes, what the sanitizers find, and more time or memory than tools/fuzz allows.
template <class Read>
void value_or_error(const Read& read) {
  try {
    read();
  } catch (const Error& error) {
    const std::string_view message = error.what();
    if (message.empty() || message.find_first_of("\r\n") != std::string_view::npos) std::abort();
  }
}

}  // namespace kappaflow
