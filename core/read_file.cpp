#include "core/read_file.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "core/errors.h"

namespace kappaflow {

// A C stream, because it tells a failure from the end of the file, and leaves the reason in errno.
std::string read_file(const std::filesystem::path& path) {
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  errno = 0;
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
  std::string bytes;
  if (file) {
    std::array<char, 1 << 16> part;
    while (const std::size_t size = std::fread(part.data(), 1, part.size(), file.get()))
      bytes.append(part.data(), size);
    if (std::ferror(file.get()) == 0) return bytes;
  }
  throw IoError(path.string(), fmt::format("cannot be read ({})", std::strerror(errno != 0 ? errno : EIO)));
}

}  // namespace kappaflow
