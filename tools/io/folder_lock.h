// Keeps two programs from writing into one folder.
#pragma once

#include <filesystem>

namespace kappaflow {

/// Held while a run writes into its folder. Goes with the process, however that ends, and leaves no file
/// behind. On file systems that know no locks it holds nothing back.
class FolderLock {
 public:
  /// folder: exists. Throws InvalidInput where another lock is held on it, IoError where it cannot be opened.
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_;
};

}  // namespace kappaflow
