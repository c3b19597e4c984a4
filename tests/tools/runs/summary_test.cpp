#include "tools/runs/summary.h"

#include <gtest/gtest.h>

namespace kappaflow {
namespace {

std::string text_after(double mean, double max, double tolerance, double viscosity_error = 0.9) {
  RunSummary summary;
  summary.density_tolerance = tolerance;
  FrameMetrics frame;
  frame.penetration_max = 0.1;
  frame.density_error_mean = mean;
  frame.density_error_max = max;
  frame.viscosity_error = viscosity_error;
  summary.add_frame({}, 0, 0);
  summary.add_frame(frame, 0, 0);
  summary.methods.resize(1);
  summary.methods[0].add_frame("total", {});
  return summary_text(summary, "A run", {}, "out/run");
}

// The first two are what scenes come to: threads that pile up, and the shipped splash.
TEST(Summary, WarnsOfLiquidThatWasSqueezed) {
  EXPECT_EQ(text_after(1.8e-3, 0.15, 1e-4).find("warning"), std::string::npos);
  EXPECT_EQ(text_after(6e-4, 0.37, 1e-4).find("warning"), std::string::npos);
  EXPECT_EQ(text_after(1.8e-2, 0.15, 1e-3).find("warning"), std::string::npos) << "as was asked for";
  EXPECT_NE(
      text_after(2.5e-2, 0.15, 1e-4)
          .find("\n  warning: the liquid was compressed far beyond density_tolerance (0.01 %): by 2.5 % in "
                "the mean, 15 % at a particle; lower max_time_step or cfl, or raise "
                "max_pressure_iterations\n"),
      std::string::npos);
  EXPECT_NE(text_after(6e-4, 0.43, 1e-4).find(": by 0.06 % in the mean, 43 % at a particle; "),
            std::string::npos);
}

TEST(Summary, WarnsOfAViscositySolveThatDidNotConverge) {
  EXPECT_EQ(text_after(0, 0, 1e-4, 1).find("warning"), std::string::npos);
  EXPECT_NE(text_after(0, 0, 1e-4, 1.25)
                .find("\n  warning: the viscosity solver did not converge in every step: its error was up to "
                      "1.2 times what viscosity_tolerance allows; raise max_viscosity_iterations or "
                      "viscosity_tolerance\n"),
            std::string::npos);
}

TEST(Summary, SaysWhatHasFlowedOut) {
  RunSummary summary;
  summary.methods.resize(1);
  summary.methods[0].add_frame("total", {});
  const auto text_with = [&](std::size_t taken, const std::string& by_region) {
    FrameMetrics frame;
    frame.particles_taken = taken;
    frame.taken_by_region = by_region;
    summary.add_frame(frame, 0, 0);
    return summary_text(summary, "A run", {}, "out/run");
  };
  EXPECT_EQ(text_with(0, "").find("outflow"), std::string::npos);
  EXPECT_NE(text_with(12, "12").find("\n  particles taken by outflow regions: 12\n"), std::string::npos);
  EXPECT_NE(text_with(12, "5 7").find("\n  particles taken by outflow regions: 12 (by region: 5 7)\n"),
            std::string::npos);
}

// The first frame's time is that of the first mesh, which the first method bears alone.
TEST(Summary, TimeAFrameIsTheMedianOfThoseAfterTheFirst) {
  RunSummary summary;
  summary.frames.resize(5);
  summary.methods.resize(2);
  for (const double seconds : {7.0, 0.25, 0.5, 0.125, 0.25}) {
    summary.methods[0].add_frame("total", {});
    summary.methods[0].add_seconds(
        {.solver = 9, .velocity = 0.5 * seconds, .texture = 0.5 * seconds, .output = 9});
  }
  summary.methods[1].add_frame("normal", {});
  const std::string text = summary_text(summary, "A run", {}, "out/run");
  EXPECT_NE(text.find("unprojected     time\n"), std::string::npos) << text;
  EXPECT_NE(text.find("0    0.250\n"), std::string::npos) << text;
  EXPECT_NE(text.find("0        -\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace kappaflow
