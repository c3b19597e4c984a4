#include "core/split_mix.h"

#include <gtest/gtest.h>

namespace kappaflow {
namespace {

// The first numbers of Vigna's splitmix64.c for the seed 1234567.
TEST(SplitMix, GivesThePublishedNumbers) {
  constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15;
  std::uint64_t state = 1234567;
  for (const std::uint64_t expected :
       {6457827717110365317u, 3203168211198807973u, 9817491932198370423u, 4593380528125082431u}) {
    EXPECT_EQ(split_mix(state), expected);
    state += kStep;
  }
}

}  // namespace
}  // namespace kappaflow
