// What is told of the heat in the liquid: temperatures, and the ways that heat takes.
#pragma once

#include <vector>

namespace kappaflow {

/// Of a fluid.
struct HeatProperties {
  double specific_heat = 1000;  ///< > 0 [J/(kg K)]
  double conductivity = 0;      ///< >= 0 [W/(m K)]
};

/// What a wall does to the liquid that touches it.
struct WallHeat {
  enum class Kind { insulated, temperature, flux };
  Kind kind = Kind::insulated;
  double value = 0;  ///< of the wall's surface [K], or into the liquid [W/m2]

  bool operator==(const WallHeat&) const = default;
};

/// Absolute temperatures.
struct HeatOptions {
  double temperature = 293.15;           ///< of liquid of which nothing else is said [K]
  std::vector<HeatProperties> fluids{};  ///< one each
  std::vector<WallHeat>
      walls{};  ///< in the order of the solver's walls, as far as it goes; the others are insulated
  double ambient_temperature = 293.15;  ///< of the air and of what the free surface faces [K]
  double convection = 0;                ///< >= 0: heat transfer from the free surface to the air [W/(m2 K)]
  double emissivity = 0;                ///< of the free surface, grey, in [0, 1]

  /// Whether the free surface loses heat.
  bool cools() const { return convection > 0 || emissivity > 0; }
};

}  // namespace kappaflow
