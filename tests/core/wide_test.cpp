#include "core/wide.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace kappaflow {
namespace {

TEST(Wide, LanesBelowALimitAreTheBitsOfThem) {
  WideDouble values;
  values << 1, 0.5, std::nextafter(1.0, 0.0), -3, std::numeric_limits<double>::quiet_NaN(), 2, 1e-300, 1;
  EXPECT_EQ(lanes_below(values, 1), 0b01001110u);
  EXPECT_EQ(lanes_below(values, -4), 0u);
}

TEST(Wide, PacksTheIndicesOfTheLanesThatAreSet) {
  std::array<std::uint32_t, kWide> out{};
  for (const unsigned lanes : {0u, 0b1u, 0b10100110u, 0xffu}) {
    pack(indices_from(1000), lanes, out.data());
    std::size_t count = 0;
    for (std::uint32_t lane = 0; lane < kWide; ++lane)
      if (lanes >> lane & 1) {
        EXPECT_EQ(out[count++], 1000 + lane) << lanes;
      }
  }
}

}  // namespace
}  // namespace kappaflow
