// The column of a cooling layer against series, balances and flows that are known.
#include "tools/experiments/cooling_column.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kappaflow {
namespace {

CoolingLayer hot_layer() {
  return {.thickness = 2,
          .acceleration = 3,
          .viscosity = 5,
          .law = {},
          .diffusivity = 0.4,
          .conductivity = 7,
          .first_temperature = 400,
          .floor_temperature = 400,
          .air_temperature = 300,
          .convection = 0};
}

// u = a / nu (H z - z^2 / 2), the film of Nusselt (1916); it goes as far as its speed and the time say.
TEST(CoolingColumn, FlowsAsAFilmWhereNothingCools) {
  CoolingColumn column(hot_layer());
  column.advance(6);
  for (const double height : {0.0, 0.25, 0.5, 1.0}) {
    const double z = 2 * height, known = 3.0 / 5 * (2 * z - z * z / 2);
    EXPECT_NEAR(column.speed(height), known, 1e-5);
    EXPECT_NEAR(column.shift(height), 6 * known, 1e-4);
    EXPECT_NEAR(column.temperature(height), 400, 1e-9);
  }
}

// Carslaw & Jaeger, "Conduction of heat in solids" (1959): Fourier's series of a layer on a colder floor.
TEST(CoolingColumn, CoolsFromTheFloorAsTheSeries) {
  CoolingLayer layer = hot_layer();
  layer.floor_temperature = 350;
  CoolingColumn column(layer);
  column.advance(1);  // a Fourier number of 0.1
  for (const double height : {0.1, 0.3, 0.6, 1.0}) {
    double known = 350;
    for (int n = 0; n < 100; ++n) {
      const double k = (n + 0.5) * std::numbers::pi;
      known += 50 * 2 / k * std::sin(k * height) * std::exp(-k * k * 0.1);
    }
    EXPECT_NEAR(column.temperature(height), known, 0.05) << height;
  }
}

// In the end as much heat goes through the floor as into the air: T falls in a straight line from 400 K to
// the surface's, k (400 - T) / H = convection (T - 300).
TEST(CoolingColumn, ComesToASteadyStateBetweenFloorAndAir) {
  CoolingLayer layer = hot_layer();
  layer.convection = 10.5;  // a Biot number of 3
  CoolingColumn column(layer);
  column.advance(20);
  EXPECT_NEAR(column.temperature(1), 325, 0.15);
  EXPECT_NEAR(column.temperature(0.5), 362.5, 0.1);
}

// In that steady state T is known, and so is u = integral of a (H - z) / nu(T(z)).
TEST(CoolingColumn, ShearsWhereItIsHot) {
  CoolingLayer layer = hot_layer();
  layer.law = Arrhenius{.activation_energy = 60000, .reference_temperature = 400};
  layer.convection = 10.5;
  CoolingColumn column(layer);
  column.advance(20);
  double known = 0;
  constexpr int kParts = 2000;
  for (int i = 0; i < kParts; ++i) {
    const double height = (i + 0.5) / kParts, temperature = 400 - 75 * height;
    const double factor = std::exp(60000 / 8.314462618 * (1 / temperature - 1.0 / 400));
    known += 2.0 / kParts * 3 * 2 * (1 - height) / (5 * factor);
  }
  EXPECT_NEAR(column.speed(1), known, 1e-3 * known);
}

}  // namespace
}  // namespace kappaflow
