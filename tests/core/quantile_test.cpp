#include "core/quantile.h"

#include <gtest/gtest.h>

#include <vector>

namespace kappaflow {
namespace {

TEST(Quantile, IsAValueAtAPlaceInAscendingOrder) {
  const auto at = [](double share) {
    std::vector<double> values{5, 1, 4, 2, 3};
    return quantile(values, share);
  };
  EXPECT_EQ(at(0), 1);
  EXPECT_EQ(at(0.24), 1);
  EXPECT_EQ(at(0.25), 2);
  EXPECT_EQ(at(0.5), 3);
  EXPECT_EQ(at(1), 5);
}

TEST(Quantile, OfTwoInTheMiddleTheUpperMedianIsTheLarger) {
  std::vector<double> odd{5, 1, 4, 2, 3}, even{4, 1, 3, 2}, one{7};
  EXPECT_EQ(upper_median(odd), 3);
  EXPECT_EQ(upper_median(even), 3);
  EXPECT_EQ(quantile(even, 0.5), 2) << "the smaller";
  EXPECT_EQ(upper_median(one), 7);
}

}  // namespace
}  // namespace kappaflow
