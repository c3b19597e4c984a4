#include "core/parallel.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace kappaflow {
namespace {

TEST(Parallel, ForVisitsEachElementOnce) {
  std::vector<int> visits(10'001, 0);
  parallel_for(visits.size(), [&](std::size_t i) { ++visits[i]; });
  EXPECT_EQ(std::accumulate(visits.begin(), visits.end(), 0), 10'001);
  EXPECT_EQ(*std::max_element(visits.begin(), visits.end()), 1);
  parallel_for(0, [](std::size_t) { FAIL(); });
}

TEST(Parallel, SumHasTheSameBitsWithAnyNumberOfThreads) {
  const auto term = [](std::size_t i) { return std::sin(static_cast<double>(i)) * 1e3; };
  std::vector<double> sums;
  for (const int threads : {1, 2, 3, 4}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    for (int repeat = 0; repeat < 5; ++repeat) sums.push_back(parallel_sum(100'003, 0.0, term));
  }
  for (const double sum : sums) EXPECT_EQ(sum, sums.front());
  double serial = 0;
  for (std::size_t i = 0; i < 100'003; ++i) serial += term(i);
  EXPECT_NEAR(sums.front(), serial, 1e-7);
}

TEST(Parallel, MaxIsAtLeastItsBound) {
  EXPECT_EQ(parallel_max(1000, -1.0, [](std::size_t i) { return i == 777 ? 5.0 : 0.0; }), 5.0);
  EXPECT_EQ(parallel_max(0, -1.0, [](std::size_t) { return 3.0; }), -1.0);
}

}  // namespace
}  // namespace kappaflow
