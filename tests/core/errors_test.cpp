#include "core/errors.h"

#include <gtest/gtest.h>

namespace kappaflow {
namespace {

TEST(Errors, SayWhereOnOneLine) {
  EXPECT_STREQ(InvalidInput({"a.toml", 12, 3}, "found x; allowed: y").what(),
               "a.toml:12:3: found x; allowed: y");
  EXPECT_STREQ(InvalidInput({"p.csv", 7, 0}, "four numbers").what(), "p.csv:7: four numbers");
  EXPECT_STREQ(InvalidInput({"p.csv", 0, 0}, "no such file").what(), "p.csv: no such file");
  EXPECT_STREQ(IoError("out/run.json", "disk full").what(), "out/run.json: disk full");
  EXPECT_STREQ(SolverFailure(0.5, 12, {17, Vec3(1, -2, 0.25), 1e6}, "step too short").what(),
               "the simulation failed at t = 0.5 s, step 12, particle 17 at (1, -2, 0.25) m with 1e+06 m/s: "
               "step too short");
  EXPECT_STREQ(TopologyError(Vec3(1, 2, 3), "edge with one triangle").what(),
               "mesh at (1, 2, 3): edge with one triangle");
}

TEST(Errors, HaveAnExitCodeEach) {
  EXPECT_EQ(InvalidInput("x").exit_code(), 2);
  EXPECT_EQ(SolverFailure(0, 1, {}, "x").exit_code(), 3);
  EXPECT_EQ(TopologyError(Vec3::Zero(), "x").exit_code(), 4);
  EXPECT_EQ(IoError("x", "y").exit_code(), 5);
}

}  // namespace
}  // namespace kappaflow
