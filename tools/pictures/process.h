// Other programs that do a part of the work.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace kappaflow {

inline constexpr int kProgramMissing = 127;  ///< as shells have it

/// Where a program runs and what it inherits.
struct ChildOptions {
  std::filesystem::path folder = "/";
  int descriptor = -1;  ///< that it inherits; -1: none but the three that all have
  bool silent = false;  ///< without standard error too, not without standard output alone
};

/// Starts a program of PATH with these words (the first is its name). It is ended (SIGTERM) when this program
/// ends, however that comes about, and Ctrl-C in a terminal does not reach it.
pid_t start_program(std::vector<std::string> words, const ChildOptions& options);

/// Waits for its end. Returns its exit status, 128 + the signal that ended it, or kProgramMissing where it is
/// not there.
int wait_for_program(pid_t program);

/// Both, in `folder`.
int run_command(std::vector<std::string> words, const std::filesystem::path& folder);

/// Tells the program to end, and waits a moment for that.
void end_program(pid_t program);

}  // namespace kappaflow
