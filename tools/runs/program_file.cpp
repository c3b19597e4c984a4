#include "tools/runs/program_file.h"

#include <fmt/format.h>

#include <system_error>

#include "core/errors.h"

namespace kappaflow {

std::filesystem::path program_file() {
  constexpr const char* kLink = "/proc/self/exe";
  std::error_code error;
  std::filesystem::path file = std::filesystem::read_symlink(kLink, error);
  if (error)
    throw IoError(kLink, fmt::format("does not say where this program is ({}); expected /proc to be there",
                                     error.message()));
  return file;
}

}  // namespace kappaflow
