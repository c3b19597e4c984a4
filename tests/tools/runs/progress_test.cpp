#include "tools/runs/progress.h"

#include <gtest/gtest.h>

namespace kappaflow {
namespace {

TEST(Progress, LineSaysHowFarAndHowLong) {
  EXPECT_EQ(progress_line(0.25, 0.75, 19, 75, 300, 30, "pressure 6, viscosity 9"),
            "[###---------] 0.750 s  frame 19/75  10.0 steps/s  pressure 6, viscosity 9  1:30 left");
}

TEST(Progress, IsSilentWithoutATerminal) {
  testing::internal::CaptureStderr();  // a file
  {
    Progress progress(0, 1, 25, true);
    progress.show(0.5, 12, "");
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace kappaflow
