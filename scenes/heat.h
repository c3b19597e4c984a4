// What a scene says of heat: its table [heat], and the keys of blocks, emitters and walls.
#pragma once

#include <optional>

#include "scenes/toml_reader.h"
#include "solver/heat_options.h"

namespace kappaflow {

/// Reads [heat]. Its properties of the liquid are those of the only entry of `fluids`. Throws InvalidInput.
HeatOptions read_heat(TomlTable t);

/// Reads `temperature` of a block or emitter; nothing where it is not there. heat: the scene's. Throws
/// InvalidInput.
std::optional<double> read_temperature(TomlTable& t, const std::optional<HeatOptions>& heat);

/// Reads `temperature` or `heat_flux` of a wall, which is insulated where neither is there. Throws
/// InvalidInput.
WallHeat read_wall_heat(TomlTable& t, const std::optional<HeatOptions>& heat);

/// Reads `specific_heat` and `conductivity` of [heat] or a material; required where there are no usual ones.
HeatProperties read_heat_properties(TomlTable& t, const std::optional<HeatProperties>& usual);

/// Throws InvalidInput at the key of a table of a scene without [heat].
void require_heat(TomlTable& t, std::string_view key, bool has_heat);

/// Absolute temperatures.
NumberRange temperature_range();

}  // namespace kappaflow
