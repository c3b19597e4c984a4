// Laws of viscosity: their formulas, limits, and a stress that rises with the shear rate.
#include "solver/rheology.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/errors.h"

namespace kappaflow {
namespace {

const HerschelBulkley kYielding{3, 0.5, 0.6, 200};

// Of all kinds, from plastic to thickening.
std::vector<Rheology> many_laws() {
  std::vector<Rheology> laws;
  for (const double index : {0.1, 0.5, 1.0, 1.5, 2.0})
    for (const double yield : {0.0, 1e-3, 10.0})
      for (const double m : {1.0, 1e4}) laws.push_back(HerschelBulkley{yield, 0.3, index, m});
  for (const double power : {0.1, 0.5, 1.0})
    for (const double sheared : {0.0, 0.02, 2.0}) {
      laws.push_back(Carreau{2, sheared, 5, power});
      laws.push_back(Cross{2, sheared, 5, power});
    }
  return laws;
}

TEST(Rheology, FollowsTheFormulas) {
  // By hand: 0.5 / sqrt(4.25) + 3 (1 - exp(-4)) / 2 for m = 2, n = 0, as close as n may come.
  EXPECT_NEAR(viscosity_at(HerschelBulkley{3, 0.5, 1e-12, 2}, 2), 0.5 / std::sqrt(4.25) + 1.5 * 0.98168436,
              1e-8);
  EXPECT_NEAR(viscosity_at(Carreau{10, 1, 2, 0.5}, 3), 1 + 9 / std::pow(37, 0.25), 1e-12);
  EXPECT_NEAR(viscosity_at(Cross{10, 1, 2, 0.5}, 8), 1 + 9.0 / 5, 1e-12);
}

TEST(Rheology, FarAboveTheRegularisationStressIsThatOfTheLaw) {
  for (const double rate : {1.0, 10.0, 1e3})
    EXPECT_NEAR(viscosity_at(kYielding, rate) * rate, 3 + 0.5 * std::pow(rate, 0.6), 1e-4 * rate);
}

TEST(Rheology, ViscosityAtRestIsFinite) {
  EXPECT_DOUBLE_EQ(viscosity_at(kYielding, 0), 3 * 200 + 0.5 * std::pow(200, 0.4));
  EXPECT_NEAR(viscosity_at(kYielding, 1e-9), viscosity_at(kYielding, 0), 1e-3);
  EXPECT_EQ(viscosity_at(Carreau{10, 1, 2, 0.5}, 0), 10);
  EXPECT_EQ(viscosity_at(Cross{10, 1, 2, 0.5}, 0), 10);
  EXPECT_NEAR(viscosity_at(Carreau{10, 1, 2, 0.5}, 1e30), 1, 1e-9);
  EXPECT_NEAR(viscosity_at(Cross{10, 1, 2, 0.5}, 1e30), 1, 1e-9);
}

TEST(Rheology, IndexOneIsNewtonian) {
  for (const double rate : {0.0, 1e-3, 1.0, 1e3}) {
    EXPECT_DOUBLE_EQ(viscosity_at(HerschelBulkley{0, 0.7, 1, 50}, rate), 0.7);
    EXPECT_DOUBLE_EQ(viscosity_at(Carreau{0.7, 0.1, 3, 1}, rate), 0.7);
  }
}

// Else one stress would have several rates, and a flow could jump between them.
TEST(Rheology, StressRisesWithTheShearRate) {
  for (const Rheology& law : many_laws()) {
    double last = 0;
    for (double rate = 1e-8; rate < 1e8; rate *= 1.3) {
      const double stress = viscosity_at(law, rate) * rate;
      ASSERT_TRUE(std::isfinite(stress));
      ASSERT_GE(stress, last * (1 - 1e-14)) << law.index() << " at " << rate;
      last = stress;
    }
  }
}

TEST(Rheology, MistakesAreRefused) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Rheology& law : many_laws()) EXPECT_NO_THROW(check_rheology(law));
  EXPECT_NO_THROW(check_rheology({}));
  const std::vector<Rheology> wrong{
      HerschelBulkley{-1, 1, 1, 1}, HerschelBulkley{1, 0, 1, 1},   HerschelBulkley{1, 1, 0, 1},
      HerschelBulkley{1, 1, 1, 0},  HerschelBulkley{nan, 1, 1, 1}, Carreau{1, 2, 1, 0.5},
      Carreau{0, 0, 1, 0.5},        Carreau{1, 0, 0, 0.5},         Carreau{1, 0, 1, 1.5},
      Cross{1, -1, 1, 0.5},         Cross{1, 0, nan, 0.5},         Cross{1, 0, 1, 0}};
  for (const Rheology& law : wrong) EXPECT_THROW(check_rheology(law), InvalidInput);
}

}  // namespace
}  // namespace kappaflow
