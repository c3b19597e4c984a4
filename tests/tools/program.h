// Runs the kappaflow program as a user's shell would.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kappaflow {

struct ProgramResult {
  int exit_code = -1;  ///< 128 + the signal when one ended it
  std::string out, err;
  std::size_t peak_memory = 0;  ///< [bytes]
  double seconds_to_end = 0;    ///< since it got the signal
};

/// A signal that the program gets once a file exists, or after a time.
struct Stop {
  int signal = 0;              ///< 0: none
  std::filesystem::path when;  ///< empty: after the time
  double after = 0;            ///< [s]
};

/// words: the command line after the program's name. environment: "NAME=value" to set, "NAME" to unset.
ProgramResult run_program(const std::vector<std::string>& words,
                          const std::vector<std::string>& environment = {}, const Stop& stop = {});

}  // namespace kappaflow
