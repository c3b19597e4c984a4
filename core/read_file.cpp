#include "core/read_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include "core/errors.h"

namespace kappaflow {

// A C stream, because it tells a failure from the end of the file, and leaves the reason in errno.
std::string read_file(const std::filesystem::path& path, std::size_t most_bytes) {
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  errno = 0;
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
  std::string bytes;
  if (file) {
    std::error_code none;  // of what has no size: then the bytes grow as they come
    if (const std::uintmax_t size = std::filesystem::file_size(path, none); !none)
      bytes.reserve(std::min<std::uintmax_t>(size, most_bytes));
    std::array<char, 1 << 16> part;
    const auto read_part = [&] {
      return std::fread(part.data(), 1, std::min(part.size(), most_bytes - bytes.size()), file.get());
    };
    while (const std::size_t size = read_part()) bytes.append(part.data(), size);
    if (std::ferror(file.get()) == 0) return bytes;
  }
  throw IoError(path.string(), fmt::format("cannot be read ({})", std::strerror(errno != 0 ? errno : EIO)));
}

}  // namespace kappaflow
