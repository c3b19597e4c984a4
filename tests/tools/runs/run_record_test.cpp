#include "tools/runs/run_record.h"

#include <gtest/gtest.h>

namespace kappaflow {
namespace {

TEST(BuildDescription, NamesTheLibraries) {
  const std::string text = build_description();
  for (const char* part : {"compiler ", " build\n", "VTK 9.", "Eigen 3.", "oneTBB 20"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
}

}  // namespace
}  // namespace kappaflow
