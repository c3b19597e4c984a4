#include "tools/runs/program_file.h"

#include <gtest/gtest.h>

namespace kappaflow {
namespace {

TEST(ProgramFile, IsTheProgramThatRuns) {
  EXPECT_EQ(program_file().filename(), "runs_tests");
  EXPECT_TRUE(std::filesystem::equivalent(program_file(), "/proc/self/exe"));
}

}  // namespace
}  // namespace kappaflow
