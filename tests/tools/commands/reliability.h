// Runs that are stopped and go on, and whether the outcome is the same bits.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/stopwatch.h"
#include "tests/tools/program.h"
#include "tests/tools/scratch.h"

namespace kappaflow {

class Reliability : public Scratch {
 protected:
  /// Seconds of a run that nobody stops.
  double run_whole(const std::vector<std::string>& words) const {
    const Stopwatch watch;
    const ProgramResult result = run_program(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return watch.seconds();
  }

  /// Starts the run in the folder, or goes on with it, until it is complete; returns how often it was
  /// stopped. whole: seconds that it takes; a part of them, so that slow machines and builds get on too.
  int run_with_stops(const std::vector<std::string>& words, const std::filesystem::path& out, int signal,
                     double whole, std::mt19937& random) const {
    std::uniform_real_distribution<double> after(0, 0.6 * whole);
    for (int stops = 0;; ++stops) {
      std::vector<std::string> command{words.front(), "--resume", out.string()};
      if (!std::filesystem::exists(out / "checkpoint.bin")) {
        command = words;
        command.emplace_back("--force");
      }
      const ProgramResult result = run_program(command, {}, {signal, {}, after(random)});
      if (result.exit_code == 128 + signal) continue;
      EXPECT_EQ(result.exit_code, 0) << result.err;
      return stops;
    }
  }
};

/// All files but those that hold wall times.
inline std::set<std::filesystem::path> results_in(const std::filesystem::path& run) {
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(run))
    if (!entry.is_directory()) files.insert(std::filesystem::relative(entry.path(), run));
  for (const char* name : {"run.json", "timings.csv"}) EXPECT_EQ(files.erase(name), 1) << name;
  return files;
}

inline void expect_same_results(const std::filesystem::path& one, const std::filesystem::path& other) {
  EXPECT_EQ(results_in(one), results_in(other));
  for (const std::filesystem::path& name : results_in(one))
    EXPECT_TRUE(bytes_of(one / name) == bytes_of(other / name)) << other / name;
}

}  // namespace kappaflow
