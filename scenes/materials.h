// What a scene says of its liquids: viscosities, and materials that tables of fluid name.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenes/toml_reader.h"
#include "solver/options.h"

namespace kappaflow {

inline constexpr double kMaxDensity = 1e6;  // [kg/m3]; keeps what is computed finite in single precision

/// What a table states of its liquid.
struct Material {
  std::string name{};    ///< empty: a viscosity
  double viscosity = 0;  ///< kinematic, at rest [m2/s]
  double density = 0;    ///< at rest [kg/m3]
  Rheology law{};
  TemperatureLaw temperature_law{};
  std::optional<HeatProperties> heat{};  ///< where they are not those of [heat]

  /// Whether there is more to it than its viscosity and density.
  bool is_told_by_name() const { return !is_newtonian(law) || has_temperature_law(temperature_law) || heat; }
};

/// The fluids of a scene while its tables are read; number 0 is that of [fluid]. Those that are no more than
/// a viscosity and a density are told apart by these, the others by their names.
class Fluids {
 public:
  /// tables: of [[material]]; their dynamic viscosities and stresses are divided by their density, that of
  /// those that state none is options.density. options.heat: as read_heat() gives it. Throws InvalidInput.
  Fluids(FluidOptions& options, std::vector<std::string>& names, std::vector<TomlTable> tables);

  /// Reads kinematic_viscosity, dynamic_viscosity or material of [fluid]. False where none is there.
  bool read_first(TomlTable& t);
  /// The number of the fluid that a block or emitter states, 0 where it states none. Throws InvalidInput for
  /// one whose density is too far from the others'.
  std::uint8_t read(TomlTable& t);
  /// After the last of them: where there is none of the first fluid, it takes the density of one that there
  /// is.
  void finish();

  const FluidOptions& options() const { return options_; }

 private:
  std::optional<Material> stated(TomlTable& t) const;
  std::optional<std::size_t> find(const Material& material) const;
  std::uint8_t number_of(const Material& material, const TomlTable& t);
  void add(const Material& material);

  FluidOptions& options_;
  std::vector<std::string>& names_;  // by fluid
  std::vector<char> by_name_;        // likewise: Material::is_told_by_name()
  double usual_density_;
  std::optional<HeatProperties> usual_heat_;
  std::vector<Material> materials_;
  std::vector<std::uint8_t> in_use_;  // fluids of blocks and emitters
};

}  // namespace kappaflow
