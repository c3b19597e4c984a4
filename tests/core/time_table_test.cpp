#include "core/time_table.h"

#include <gtest/gtest.h>

namespace kappaflow {
namespace {

TEST(TimeTable, IsLinearBetweenItsKeysAndConstantOutside) {
  const TimeTable<double> table{{{1, 2}, {3, 6}, {4, 0}}};
  EXPECT_EQ(table.at(0), 2);
  EXPECT_EQ(table.at(1), 2);
  EXPECT_DOUBLE_EQ(table.at(2.5), 5);
  EXPECT_EQ(table.at(3), 6);
  EXPECT_DOUBLE_EQ(table.at(3.25), 4.5);
  EXPECT_EQ(table.at(9), 0);
}

// Against a sum over many short pieces, whichever keys lie in the interval.
TEST(TimeTable, MeanIsTheIntegralOverTheTime) {
  const TimeTable<Vec3> table{{{1, {2, 0, 1}}, {3, {6, -3, 1}}, {4, {0, 5, 1}}}};
  for (const auto& [t0, t1] :
       {std::pair(0.0, 0.5), {0.0, 2.0}, {1.5, 2.5}, {0.0, 6.0}, {2.0, 3.5}, {5.0, 7.0}}) {
    constexpr int kPieces = 100000;
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < kPieces; ++k) sum += table.at(t0 + (k + 0.5) * (t1 - t0) / kPieces);
    EXPECT_LT((table.mean(t0, t1) - sum / kPieces).norm(), 1e-7) << t0 << " to " << t1;
  }
  EXPECT_EQ(table.mean(2, 2), table.at(2));
}

TEST(TimeTable, ConstantOneGivesThatVeryValue) {
  const double value = 9.81 / 7;
  const TimeTable<double> table{{{0.1, value}, {0.7, value}, {0.9, value}}};
  for (double t = 0; t < 1; t += 0.0137) {
    EXPECT_EQ(table.at(t), value);
    EXPECT_EQ(table.mean(t, t + 0.3), value);
    EXPECT_EQ(table.largest(t, t + 0.3), value);
  }
}

TEST(TimeTable, LargestIsOfTheLength) {
  const TimeTable<Vec3> table{{{0, {0, -3, 0}}, {1, {0, 1, 0}}, {2, {0, 1, 4}}}};
  EXPECT_EQ(table.largest(0, 1), 3);
  EXPECT_DOUBLE_EQ(table.largest(0.5, 0.75), 1);
  EXPECT_DOUBLE_EQ(table.largest(1, 5), std::sqrt(17));
}

TEST(TimeTable, TimesMustAscend) {
  EXPECT_TRUE((TimeTable<double>{{{0, 1}, {1, 1}}}.ascends()));
  EXPECT_FALSE((TimeTable<double>{{{1, 1}, {1, 2}}}.ascends()));
  EXPECT_FALSE((TimeTable<double>{{{0, 1}, {std::nan(""), 2}}}.ascends()));
}

}  // namespace
}  // namespace kappaflow
