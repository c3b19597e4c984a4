#include "solver/rheology.h"

#include <fmt/format.h>

#include <cmath>

#include "core/errors.h"

namespace kappaflow {
namespace {

void require(bool holds, const char* name, double value, const char* allowed) {
  if (!holds) throw InvalidInput(fmt::format("fluid: {} = {}; must be {}", name, value, allowed));
}

void require_positive(const char* name, double value) {
  require(std::isfinite(value) && value > 0, name, value, "greater than 0");
}

void require_viscosities(double at_rest, double sheared) {
  require_positive("viscosity at rest", at_rest);
  require(sheared >= 0 && sheared <= at_rest, "viscosity in fast shear", sheared,
          "0 or greater, and not above that at rest");
}

struct ViscosityAt {
  double g;  // shear rate

  double operator()(std::monostate) const { return 0; }
  double operator()(const HerschelBulkley& law) const {
    const double m = law.regularisation, rest = 1 / m;
    const double thinned = law.consistency * std::pow(g * g + rest * rest, (law.index - 1) / 2);
    const double yield = g > 0 ? -std::expm1(-m * g) / g : m;
    return thinned + law.yield_stress * yield;
  }
  double operator()(const Carreau& law) const {
    const double thinned = std::pow(1 + std::pow(law.time * g, 2), (law.index - 1) / 2);
    return law.sheared + (law.at_rest - law.sheared) * thinned;
  }
  double operator()(const Cross& law) const {
    return law.sheared + (law.at_rest - law.sheared) / (1 + std::pow(law.time * g, law.exponent));
  }
};

struct CheckRheology {
  void operator()(std::monostate) const {}
  void operator()(const HerschelBulkley& law) const {
    require(std::isfinite(law.yield_stress) && law.yield_stress >= 0, "yield stress", law.yield_stress,
            "0 or greater");
    require_positive("consistency", law.consistency);
    require_positive("flow index", law.index);
    require_positive("regularisation", law.regularisation);
  }
  void operator()(const Carreau& law) const {
    require_viscosities(law.at_rest, law.sheared);
    require_positive("time of the Carreau law", law.time);
    require(law.index > 0 && law.index <= 1, "flow index", law.index, "in (0, 1]");
  }
  void operator()(const Cross& law) const {
    require_viscosities(law.at_rest, law.sheared);
    require_positive("time of the Cross law", law.time);
    require(law.exponent > 0 && law.exponent <= 1, "exponent", law.exponent, "in (0, 1]");
  }
};

}  // namespace

double viscosity_at(const Rheology& law, double shear_rate) {
  return std::visit(ViscosityAt{shear_rate}, law);
}

void check_rheology(const Rheology& law) {
  std::visit(CheckRheology(), law);
}

}  // namespace kappaflow
