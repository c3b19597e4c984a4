#include "tools/files.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <system_error>

#include "core/errors.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

// C streams, because their calls leave the reason in errno. Returns 0 or that reason.
int write_all(const fs::path& path, const char* mode, std::string_view content) {
  errno = 0;
  std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), mode));
  if (!file) return errno;
  const bool written = std::fwrite(content.data(), 1, content.size(), file.get()) == content.size() &&
                       std::fflush(file.get()) == 0;
  if (!written) return errno != 0 ? errno : EIO;
  return std::fclose(file.release()) == 0 ? 0 : errno;
}

[[noreturn]] void fail(const fs::path& path, const char* what, int reason) {
  throw IoError(path.string(), std::string(what) + " (" + std::strerror(reason) + ")");
}

}  // namespace

void write_file(const fs::path& path, std::string_view content) {
  const fs::path temporary = path.string() + ".tmp";
  int reason = write_all(temporary, "wb", content);
  if (reason == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) reason = errno;
  if (reason == 0) return;
  std::error_code ignored;  // the first failure is the one to report
  fs::remove(temporary, ignored);
  fail(path, "cannot be written", reason);
}

void append_lines(const fs::path& path, std::string_view lines) {
  std::error_code missing;
  const std::uintmax_t size = fs::file_size(path, missing);
  if (missing) fail(path, "cannot be appended to", missing.value());
  const int reason = write_all(path, "ab", lines);
  if (reason == 0) return;
  std::error_code ignored;
  fs::resize_file(path, size, ignored);
  fail(path, "cannot be appended to", reason);
}

std::string read_file(const fs::path& path) {
  check_readable(path);
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

void check_readable(const fs::path& path) {
  errno = 0;
  const std::ifstream stream(path, std::ios::binary);
  if (!stream || fs::is_directory(path)) fail(path, "cannot be read", errno != 0 ? errno : EISDIR);
}

void make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) fail(path, "the folder cannot be made", error.value());
}

}  // namespace kappaflow
