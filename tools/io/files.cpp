#include "tools/io/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <mutex>
#include <set>
#include <system_error>

#include "core/errors.h"
#include "core/read_file.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

// C streams, because their calls leave the reason in errno. Returns 0 or that reason.
int write_all(const fs::path& path, const char* mode, std::initializer_list<std::string_view> parts) {
  errno = 0;
  std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), mode));
  if (!file) return errno;
  bool written = true;
  for (const std::string_view part : parts)
    written = written && std::fwrite(part.data(), 1, part.size(), file.get()) == part.size();
  written = written && std::fflush(file.get()) == 0;
  if (!written) return errno != 0 ? errno : EIO;
  return std::fclose(file.release()) == 0 ? 0 : errno;
}

/// Returns 0 or the reason of the failure.
int flush(const fs::path& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int reason = fsync(descriptor) == 0 || errno == EINVAL ? 0 : errno;  // EINVAL: nothing to flush there
  close(descriptor);
  return reason;
}

[[noreturn]] void fail(const fs::path& path, const std::string& what, int reason) {
  throw IoError(path.string(), fmt::format("{} ({})", what, std::strerror(reason)));
}

[[noreturn]] void fail_to_write(const fs::path& path, const char* what, std::size_t bytes, int reason) {
  fail(path, fmt::format("{} bytes cannot be {}", bytes, what), reason);
}

/// flushed: before the file gets its name.
void replace_file(const fs::path& path, std::initializer_list<std::string_view> parts, bool flushed) {
  const UnfinishedFile temporary(path.string() + ".tmp");
  int reason = write_all(temporary.path(), "wb", parts);
  if (reason == 0 && flushed) reason = flush(temporary.path());
  if (reason == 0 && std::rename(temporary.path().c_str(), path.c_str()) != 0) reason = errno;
  if (reason == 0) return;
  std::size_t bytes = 0;
  for (const std::string_view part : parts) bytes += part.size();
  fail_to_write(path, "written", bytes, reason);
}

std::mutex unfinished_guard;
std::set<fs::path> unfinished;

}  // namespace

UnfinishedFile::UnfinishedFile(fs::path path) : path_(std::move(path)) {
  const std::lock_guard lock(unfinished_guard);
  unfinished.insert(path_);
}

// Where it was renamed there is nothing to remove.
UnfinishedFile::~UnfinishedFile() {
  std::error_code ignored;  // whoever wrote it reports the first failure
  fs::remove(path_, ignored);
  const std::lock_guard lock(unfinished_guard);
  unfinished.erase(path_);
}

void remove_unfinished_files() {
  unfinished_guard.lock();  // for good
  std::error_code ignored;
  for (const fs::path& path : unfinished) fs::remove(path, ignored);
}

void write_file(const fs::path& path, std::string_view content) {
  replace_file(path, {content}, false);
}

void write_file_durably(const fs::path& path, std::initializer_list<std::string_view> parts) {
  replace_file(path, parts, true);
  flush_to_disk(path.parent_path());
}

void flush_to_disk(const fs::path& path) {
  if (const int reason = flush(path); reason != 0) fail(path, "cannot be flushed to the disk", reason);
}

void append_lines(const fs::path& path, std::string_view lines) {
  std::error_code error;
  const std::uint64_t size = fs::file_size(path, error);
  if (error) fail(path, "cannot be read", error.value());
  const int reason = write_all(path, "ab", {lines});
  if (reason == 0) return;
  std::error_code ignored;
  fs::resize_file(path, size, ignored);
  fail_to_write(path, "appended", lines.size(), reason);
}

void cut_to_lines(const fs::path& path, std::size_t lines) {
  const std::string text = read_file(path);
  std::size_t size = 0;
  for (std::size_t line = 0; line < lines; ++line) {
    const std::size_t end = text.find('\n', size);
    if (end == std::string::npos)
      throw IoError(path.string(), fmt::format("has {} lines; it had {}", line, lines));
    size = end + 1;
  }
  std::error_code error;
  fs::resize_file(path, size, error);
  if (error) fail(path, "cannot be cut back", error.value());
}

void remove_file(const fs::path& path) {
  std::error_code error;
  fs::remove(path, error);
  if (error) fail(path, "cannot be removed", error.value());
}

void make_folder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) fail(path, "the folder cannot be made", error.value());
}

}  // namespace kappaflow
