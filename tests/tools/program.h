// Runs the kappaflow program as a user's shell would.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kappaflow {

struct ProgramResult {
  int exit_code = -1;  ///< 128 + the signal when one ended it
  std::string out, err;
};

/// words: the command line after the program's name. environment: "NAME=value" to set, "NAME" to unset.
/// interrupt_when: once this file exists, the program gets SIGINT.
ProgramResult run_program(const std::vector<std::string>& words,
                          const std::vector<std::string>& environment = {},
                          const std::filesystem::path& interrupt_when = {});

}  // namespace kappaflow
