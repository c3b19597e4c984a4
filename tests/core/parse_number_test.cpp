#include "core/parse_number.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace kappaflow {
namespace {

TEST(ParseNumber, TakesTheWholeTextOrNone) {
  EXPECT_EQ(parse_number<double>("-1.5e3"), -1500);
  EXPECT_EQ(parse_number<std::int64_t>("-7"), -7);
  for (const char* text : {"", "1 ", " 1", "+1", "1,5", "1.5x", "one"})
    EXPECT_FALSE(parse_number<double>(text)) << '"' << text << '"';
  EXPECT_FALSE(parse_number<int>("1.5"));
  EXPECT_FALSE(parse_number<unsigned>("-1"));
}

TEST(ParseNumber, RefusesWhatTheTypeCannotHold) {
  EXPECT_EQ(parse_number<std::uint8_t>("255"), 255);
  EXPECT_FALSE(parse_number<std::uint8_t>("256"));
  EXPECT_FALSE(parse_number<double>("1e999"));
}

TEST(ParseNumber, APlusIsTakenOffWhereAFormatAllowsIt) {
  EXPECT_EQ(parse_number<double>(without_plus("+1.5")), 1.5);
  EXPECT_EQ(parse_number<double>(without_plus("1.5")), 1.5);
  EXPECT_FALSE(parse_number<double>(without_plus("++1.5")));
}

}  // namespace
}  // namespace kappaflow
