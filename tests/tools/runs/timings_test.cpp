#include "tools/runs/timings.h"

#include <gtest/gtest.h>

#include <vector>

namespace kappaflow {
namespace {

TEST(TimingsTable, IsInMillisecondsAndMebibytes) {
  EXPECT_EQ(timings_header(),
            "frame,time,method,solver_ms,velocity_ms,fairing_ms,topology_ms,remesh_ms,texture_ms,output_ms,"
            "memory_mib\n");
  EXPECT_EQ(timings_row(2, 0.08, "total", {1.5, 0.25, 0.125, 0.5, 0, 0.75, 0.001}, 64.25),
            "2,0.08,total,1500,250,125,500,0,750,1,64.2\n");
}

TEST(TimingsTable, MemoryIsWhatTheProgramHolds) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "the sanitizer holds four bytes for each of the program's";
#endif
  const double before = resident_memory();
  EXPECT_GT(before, 1);
  const std::vector<char> block(std::size_t{64} << 20, 'x');
  EXPECT_NEAR(resident_memory() - before, 64, 8) << block.size();
}

}  // namespace
}  // namespace kappaflow
