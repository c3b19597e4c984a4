#include "scenes/heat.h"

namespace kappaflow {
namespace {

// Bounds that keep what is computed finite.
constexpr double kHottest = 1e5;          // [K]
constexpr double kMinSpecificHeat = 1;    // [J/(kg K)]
constexpr double kMaxSpecificHeat = 1e6;  // [J/(kg K)]
constexpr double kMaxConductivity = 1e6;  // [W/(m K)]
constexpr double kMaxConvection = 1e6;    // [W/(m2 K)]
constexpr double kMaxFlux = 1e9;          // [W/m2]

}  // namespace

NumberRange temperature_range() {
  return positive("K", kHottest);
}

HeatProperties read_heat_properties(TomlTable& t, const std::optional<HeatProperties>& usual) {
  const auto fallback = [&](double HeatProperties::*member) {
    return usual ? std::optional((*usual).*member) : std::nullopt;
  };
  HeatProperties result;
  result.specific_heat = t.number("specific_heat", {kMinSpecificHeat, kMaxSpecificHeat, false, "J/(kg K)"},
                                  fallback(&HeatProperties::specific_heat));
  result.conductivity = t.number("conductivity", non_negative("W/(m K)", kMaxConductivity),
                                 fallback(&HeatProperties::conductivity));
  return result;
}

HeatOptions read_heat(TomlTable t) {
  HeatOptions heat;
  heat.temperature = t.number("temperature", temperature_range());
  heat.fluids = {read_heat_properties(t, {})};
  heat.ambient_temperature = t.number("ambient_temperature", temperature_range(), heat.ambient_temperature);
  heat.convection = t.number("convection", non_negative("W/(m2 K)", kMaxConvection), heat.convection);
  heat.emissivity = t.number("emissivity", {0, 1, false, ""}, heat.emissivity);
  t.finish();
  return heat;
}

void require_heat(TomlTable& t, std::string_view key, bool has_heat) {
  if (!has_heat && t.has(key)) t.refuse(key, "only in a scene with a table [heat]");
}

std::optional<double> read_temperature(TomlTable& t, const std::optional<HeatOptions>& heat) {
  require_heat(t, "temperature", heat.has_value());
  if (!t.has("temperature")) return std::nullopt;
  return t.number("temperature", temperature_range());
}

WallHeat read_wall_heat(TomlTable& t, const std::optional<HeatOptions>& heat) {
  require_heat(t, "heat_flux", heat.has_value());
  const std::optional<double> temperature = read_temperature(t, heat);
  if (temperature && t.has("heat_flux"))
    t.refuse("heat_flux", "either a temperature or a heat_flux, not both");
  if (temperature) return {WallHeat::Kind::temperature, *temperature};
  if (!t.has("heat_flux")) return {};
  return {WallHeat::Kind::flux, t.number("heat_flux", {-kMaxFlux, kMaxFlux, false, "W/m2"})};
}

}  // namespace kappaflow
