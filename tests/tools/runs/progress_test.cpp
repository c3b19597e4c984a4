#include "tools/runs/progress.h"

#include <gtest/gtest.h>

namespace kappaflow {
namespace {

TEST(Progress, LineSaysHowFarAndHowLong) {
  EXPECT_EQ(progress_line(0.25, 0.75, 19, 75, 300, 30, "pressure 6, viscosity 9"),
            "[###---------] 0.750 s  frame 19/75  10.0 steps/s  pressure 6, viscosity 9  1:30 left");
}

TEST(Progress, OfPiecesOfWorkSaysHowMuchTimeIsLeft) {
  EXPECT_EQ(work_line("drawing frame", 0, 76, 0.1), "drawing frame 1 of 76  ? left");
  EXPECT_EQ(work_line("drawing frame", 19, 76, 30), "drawing frame 20 of 76  1:30 left");
}

TEST(Progress, IsSilentWithoutATerminal) {
  testing::internal::CaptureStderr();  // a file
  {
    Progress progress(0, 1, 25, true);
    progress.show(0.5, 12, "");
    WorkProgress work("drawing frame", 3);
    work.show(1);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace kappaflow
