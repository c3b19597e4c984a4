// Files that are either complete under their final name or absent.
#pragma once

#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

namespace kappaflow {

/// Writes `content` to a temporary file beside `path` and renames it, so that nobody ever sees half of it.
/// Throws IoError (the disk is full, no permission, ...) and leaves neither file nor temporary behind.
void write_file(const std::filesystem::path& path, std::string_view content);

/// The same of parts, one after the other, and it returns only when the file is on the disk, where a power
/// cut leaves it.
void write_file_durably(const std::filesystem::path& path, std::initializer_list<std::string_view> parts);

/// Returns when what was written into the file, or the names in the folder, are on the disk. Throws IoError.
void flush_to_disk(const std::filesystem::path& path);

/// A file that is not to stay under this name: it is renamed, or goes when the program ends.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(std::filesystem::path path);
  ~UnfinishedFile();
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Removes them all. For a thread that ends the program: no other can begin a file after that.
void remove_unfinished_files();

/// Appends whole lines and flushes; a failed append leaves the file as it was. Throws IoError.
void append_lines(const std::filesystem::path& path, std::string_view lines);

/// Cuts what stands after the first `lines` lines. Throws IoError, also where the file has fewer whole lines.
void cut_to_lines(const std::filesystem::path& path, std::size_t lines);

/// Takes the file away, if there is one. Throws IoError.
void remove_file(const std::filesystem::path& path);

/// Makes the folder and those above it. Throws IoError.
void make_folder(const std::filesystem::path& path);

}  // namespace kappaflow
