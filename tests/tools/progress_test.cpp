#include "tools/progress.h"

#include <gtest/gtest.h>

namespace kappaflow {
namespace {

TEST(Progress, LineSaysHowFarAndHowLong) {
  FluidStep step;
  step.density_iterations = 4;
  step.divergence_iterations = 2;
  step.viscosity_iterations = 9;
  EXPECT_EQ(progress_line(0.75, 3, 19, 75, 300, 30, step),
            "[###---------] 0.750 s  frame 19/75  10.0 steps/s  pressure 6, viscosity 9  1:30 left");
}

TEST(Progress, IsSilentWithoutATerminal) {
  testing::internal::CaptureStderr();  // a file
  {
    Progress progress(1, 25, true);
    progress.show(0.5, 12, {});
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace kappaflow
