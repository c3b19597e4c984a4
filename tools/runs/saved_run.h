// The checkpoint that a run goes on from.
#pragma once

#include <filesystem>
#include <sstream>
#include <string>

#include "core/saved_state.h"

namespace kappaflow {

/// A checkpoint that is being read: in turn what the run was begun with, its last frame, and its state.
class SavedRun {
 public:
  /// command: of kappaflow, that goes on with it. Throws IoError where the folder holds no checkpoint or the
  /// file is damaged, InvalidInput where another command wrote it.
  SavedRun(const std::filesystem::path& folder, const std::string& command);

  /// The values that follow. Throws IoError where the file does not hold them.
  template <class... Values>
  void read(Values&... values) {
    try {
      archive_(values...);
    } catch (const cereal::Exception&) {
      bytes_.setstate(std::ios::failbit);
    }
    check();
  }
  /// Throws IoError unless everything was read.
  void require_end();

 private:
  void check() const;

  std::filesystem::path file_;
  std::istringstream bytes_;
  StateReader archive_;
};

}  // namespace kappaflow
