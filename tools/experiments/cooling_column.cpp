#include "tools/experiments/cooling_column.h"

#include <algorithm>
#include <cmath>

namespace kappaflow {
namespace {

constexpr std::size_t kColumnCells = 400;
// Of a time step, over thickness^2 / diffusivity: heat crosses three cells in it. Error of the first order:
// a tenth of a percent of what has cooled within a tenth of that time.
constexpr double kColumnStep = 5e-5;

/// Linear between the values at even places from `first` to `last`; beyond them the outermost.
double interpolated(const std::vector<double>& values, double first, double last, double place) {
  const double x =
      std::clamp((place - first) / (last - first), 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(x), values.size() - 2);
  return values[k] + (x - static_cast<double>(k)) * (values[k + 1] - values[k]);
}

}  // namespace

CoolingColumn::CoolingColumn(const CoolingLayer& layer)
    : layer_(layer),
      cell_(layer.thickness / kColumnCells),
      temperature_(kColumnCells, layer.first_temperature),
      speed_(kColumnCells + 1, 0),
      shift_(kColumnCells + 1, 0),
      upper_(kColumnCells),
      value_(kColumnCells) {
  shear();
}

void CoolingColumn::advance(double time) {
  const double longest = kColumnStep * layer_.thickness * layer_.thickness / layer_.diffusivity;
  const double steps = std::ceil((time - time_) / longest), dt = (time - time_) / steps;
  for (double k = 0; k < steps; ++k) {
    for (std::size_t i = 0; i <= kColumnCells; ++i) shift_[i] += dt / 2 * speed_[i];
    conduct(dt);
    shear();
    for (std::size_t i = 0; i <= kColumnCells; ++i) shift_[i] += dt / 2 * speed_[i];
  }
  time_ = time;
}

/// Between the floor and the lowest cell's middle, and the topmost and the air, half a cell conducts.
void CoolingColumn::conduct(double dt) {
  const double share = dt * layer_.diffusivity / (cell_ * cell_),
               biot = layer_.convection * cell_ / layer_.conductivity;
  const double floor = 2 * share, air = share * biot / (1 + biot / 2);
  for (std::size_t i = 0; i < kColumnCells; ++i) {
    const double below = i == 0 ? 0 : share, above = i + 1 == kColumnCells ? 0 : share;
    const double outside = (i == 0 ? floor : 0) + (i + 1 == kColumnCells ? air : 0);
    const double pivot = 1 + below + above + outside - (i == 0 ? 0 : below * upper_[i - 1]);
    upper_[i] = above / pivot;
    value_[i] = temperature_[i] + (i == 0 ? floor * layer_.floor_temperature : below * value_[i - 1]) +
                (i + 1 == kColumnCells ? air * layer_.air_temperature : 0);
    value_[i] /= pivot;
  }
  for (std::size_t i = kColumnCells; i-- > 0;)
    temperature_[i] = value_[i] + (i + 1 == kColumnCells ? 0 : upper_[i] * temperature_[i + 1]);
}

void CoolingColumn::shear() {
  for (std::size_t i = 0; i < kColumnCells; ++i) {
    const double above = layer_.thickness - (static_cast<double>(i) + 0.5) * cell_;
    const double viscosity = layer_.viscosity * shift_factor(layer_.law, temperature_[i]);
    speed_[i + 1] = speed_[i] + cell_ * layer_.acceleration * above / viscosity;
  }
}

double CoolingColumn::temperature(double height) const {
  return interpolated(temperature_, 0.5 / kColumnCells, 1 - 0.5 / kColumnCells, height);
}

double CoolingColumn::speed(double height) const {
  return interpolated(speed_, 0, 1, height);
}

double CoolingColumn::shift(double height) const {
  return interpolated(shift_, 0, 1, height);
}

}  // namespace kappaflow
