#include "solver/temperature_law.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.h"

namespace kappaflow {
namespace {

constexpr double kGasConstant = 8.31446261815324;  // [J/(mol K)]

void require(bool holds, const char* name, double value, const char* allowed) {
  if (!holds) throw InvalidInput(fmt::format("fluid: {} = {}; must be {}", name, value, allowed));
}

void require_reference(double temperature) {
  require(std::isfinite(temperature) && temperature > 0, "reference temperature", temperature,
          "greater than 0");
}

struct LogarithmAt {
  double temperature;

  double operator()(std::monostate) const { return 0; }
  double operator()(const Arrhenius& law) const {
    return law.activation_energy / kGasConstant * (1 / temperature - 1 / law.reference_temperature);
  }
  double operator()(const VogelFulcherTammann& law) const {
    if (temperature <= law.vogel_temperature) return law.constant > 0 ? INFINITY : 0;
    return law.constant / (temperature - law.vogel_temperature) -
           law.constant / (law.reference_temperature - law.vogel_temperature);
  }
};

struct CheckLaw {
  void operator()(std::monostate) const {}
  void operator()(const Arrhenius& law) const {
    require(std::isfinite(law.activation_energy) && law.activation_energy >= 0, "activation energy",
            law.activation_energy, "0 or greater");
    require_reference(law.reference_temperature);
  }
  void operator()(const VogelFulcherTammann& law) const {
    require(std::isfinite(law.constant) && law.constant >= 0, "Vogel constant", law.constant, "0 or greater");
    require_reference(law.reference_temperature);
    require(law.vogel_temperature >= 0 && law.vogel_temperature < law.reference_temperature,
            "Vogel temperature", law.vogel_temperature, "0 or greater and below the reference temperature");
  }
};

}  // namespace

double shift_factor(const TemperatureLaw& law, double temperature) {
  return std::min(std::exp(std::visit(LogarithmAt{temperature}, law)), kMostShift);
}

void check_temperature_law(const TemperatureLaw& law) {
  std::visit(CheckLaw(), law);
}

}  // namespace kappaflow
