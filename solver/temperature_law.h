// Liquids whose viscosity depends on their temperature.
#pragma once

#include <variant>

namespace kappaflow {

// The laws give the shift factor a(T) [1], 1 at the reference temperature and the larger the colder the
// liquid is.

/// Arrhenius, "Ueber die innere Reibung verduennter waesseriger Loesungen" (1887):
///   a(T) = exp(E / R (1 / T - 1 / T_r)),   R the gas constant.
struct Arrhenius {
  double activation_energy = 0;      ///< E >= 0 [J/mol]
  double reference_temperature = 0;  ///< T_r > 0 [K]
};

/// Vogel (1921), Fulcher (1925), Tammann & Hesse (1926), for melts that become glass:
///   a(T) = exp(B / (T - T_0) - B / (T_r - T_0)),   infinite for T <= T_0.
struct VogelFulcherTammann {
  double constant = 0;               ///< B >= 0 [K]; of laws in powers of ten ln 10 times theirs
  double vogel_temperature = 0;      ///< T_0 >= 0, below T_r [K]
  double reference_temperature = 0;  ///< T_r > 0 [K]
};

/// None: the viscosity is the same at all temperatures.
using TemperatureLaw = std::variant<std::monostate, Arrhenius, VogelFulcherTammann>;

inline bool has_temperature_law(const TemperatureLaw& law) {
  return law.index() != 0;
}

/// a(T), at most kMostShift. temperature > 0 [K].
double shift_factor(const TemperatureLaw& law, double temperature);
/// Liquid that is so much stiffer than at the reference temperature is as good as solid.
inline constexpr double kMostShift = 1e6;

/// Throws InvalidInput for numbers out of range.
void check_temperature_law(const TemperatureLaw& law);

}  // namespace kappaflow
