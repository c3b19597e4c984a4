#include "scenes/materials.h"

#include <fmt/format.h>

#include <algorithm>

#include "scenes/heat.h"

namespace kappaflow {
namespace {

// Bounds that keep what is computed finite in single precision.
constexpr double kMaxViscosity = 1e9;  // [m2/s], [Pa s]
constexpr double kMaxStress = 1e9;     // [Pa]
constexpr double kLongestTime = 1e6;   // [s]
constexpr double kMaxIndex = 2;
constexpr double kMaxActivationEnergy = 1e7;  // [J/mol]
constexpr double kMaxVogelConstant = 1e6;     // [K]
constexpr std::size_t kMaxFluids = 256;

/// kinematic_viscosity [m2/s], or dynamic_viscosity [Pa s] over the density; nothing where neither is given.
std::optional<double> read_viscosity(TomlTable& t, double density) {
  const bool dynamic = t.has("dynamic_viscosity"), kinematic = t.has("kinematic_viscosity");
  if (dynamic && kinematic)
    t.refuse("dynamic_viscosity", "either kinematic_viscosity or dynamic_viscosity, not both");
  if (dynamic) return t.number("dynamic_viscosity", non_negative("Pa s", kMaxViscosity)) / density;
  if (kinematic) return t.number("kinematic_viscosity", non_negative("m2/s", kMaxViscosity));
  return std::nullopt;
}

HerschelBulkley read_herschel_bulkley(TomlTable& t, double density, bool yields, bool linear) {
  HerschelBulkley law;
  if (yields) law.yield_stress = t.number("yield_stress", non_negative("Pa", kMaxStress)) / density;
  law.consistency = linear ? t.number("plastic_viscosity", positive("Pa s", kMaxViscosity)) / density
                           : t.number("consistency", positive("Pa s^n", kMaxViscosity)) / density;
  if (!linear) law.index = t.number("index", positive("", kMaxIndex));
  law.regularisation = t.number("regularisation", positive("s", kLongestTime), law.regularisation);
  t.finish();
  return law;
}

/// Carreau or Cross.
template <class Law>
Law read_thinning(TomlTable& t, double density, double Law::*power, std::string_view power_key) {
  const double at_rest = t.number("zero_shear_viscosity", positive("Pa s", kMaxViscosity)),
               sheared = t.number("infinite_shear_viscosity", non_negative("Pa s", kMaxViscosity), 0);
  Law law{at_rest / density, sheared / density, t.number("time_constant", positive("s", kLongestTime)), 1};
  law.*power = t.number(power_key, positive("", 1));
  t.finish();
  if (sheared > at_rest)
    t.refuse("infinite_shear_viscosity", fmt::format("at most zero_shear_viscosity, {} Pa s", at_rest));
  return law;
}

/// The law, or none.
TemperatureLaw read_temperature_law(TomlTable& t, bool has_heat) {
  enum class Kind { arrhenius, vogel };
  static constexpr Named<Kind> kKinds[] = {{"arrhenius", Kind::arrhenius},
                                           {"vogel-fulcher-tammann", Kind::vogel}};
  require_heat(t, "temperature_law", has_heat);
  if (!t.has("temperature_law")) return {};
  const Kind kind = t.choice("temperature_law", kKinds, {});
  const double reference = t.number("reference_temperature", temperature_range());
  if (kind == Kind::arrhenius)
    return Arrhenius{t.number("activation_energy", non_negative("J/mol", kMaxActivationEnergy)), reference};
  const VogelFulcherTammann law{t.number("vogel_constant", non_negative("K", kMaxVogelConstant)),
                                t.number("vogel_temperature", {0, kUnbounded, false, "K"}), reference};
  if (t.has("reference_temperature") && t.has("vogel_temperature") &&
      law.vogel_temperature >= law.reference_temperature)
    t.refuse("vogel_temperature", fmt::format("below reference_temperature, {} K", reference));
  return law;
}

Material read_material(TomlTable& t, double usual_density, const std::optional<HeatProperties>& usual) {
  enum class Model { newtonian, power_law, bingham, herschel_bulkley, carreau, cross };
  static constexpr Named<Model> kModels[] = {
      {"newtonian", Model::newtonian}, {"power-law", Model::power_law},
      {"bingham", Model::bingham},     {"herschel-bulkley", Model::herschel_bulkley},
      {"carreau", Model::carreau},     {"cross", Model::cross}};
  Material m;
  m.name = t.text("name");
  const double density = m.density = t.number("density", positive("kg/m3", kMaxDensity), usual_density);
  const Model model = t.choice("model", kModels, {});
  m.temperature_law = read_temperature_law(t, usual.has_value());
  for (const std::string_view key : {"specific_heat", "conductivity"})
    require_heat(t, key, usual.has_value());
  if (t.has("specific_heat") || t.has("conductivity")) m.heat = read_heat_properties(t, usual);
  if (model == Model::newtonian) {
    const std::optional<double> viscosity = read_viscosity(t, density);
    t.finish();
    if (!viscosity)
      throw InvalidInput(t.where(),
                         "missing the viscosity in [[material]]; required: either kinematic_viscosity [m2/s] "
                         "or dynamic_viscosity [Pa s]");
    m.viscosity = *viscosity;
    return m;
  }
  if (model == Model::carreau)
    m.law = read_thinning(t, density, &Carreau::index, "index");
  else if (model == Model::cross)
    m.law = read_thinning(t, density, &Cross::exponent, "exponent");
  else
    m.law = read_herschel_bulkley(t, density, model != Model::power_law, model == Model::bingham);
  m.viscosity = viscosity_at(m.law, 0);
  if (m.viscosity > kMaxViscosity)
    throw InvalidInput(t.where(),
                       fmt::format("the material's viscosity at rest is {:.3g} m2/s; allowed: at most {:.0e} "
                                   "m2/s, by a shorter regularisation",
                                   m.viscosity, kMaxViscosity));
  return m;
}

}  // namespace

Fluids::Fluids(FluidOptions& options, std::vector<std::string>& names, std::vector<TomlTable> tables)
    : options_(options), names_(names), usual_density_(options.density) {
  if (options.heat) {
    usual_heat_ = options.heat->fluids.front();
    options.heat->fluids.clear();
  }
  for (TomlTable& t : tables) {
    materials_.push_back(read_material(t, options.density, usual_heat_));
    const std::string& name = materials_.back().name;
    if (std::ranges::count(materials_, name, &Material::name) > 1)
      t.refuse("name", "a name that no other [[material]] has");
  }
}

/// Nothing where the table says nothing.
std::optional<Material> Fluids::stated(TomlTable& t) const {
  const std::optional<double> viscosity = read_viscosity(t, usual_density_);
  if (!t.has("material"))
    return viscosity ? std::optional(Material{.viscosity = *viscosity, .density = usual_density_})
                     : std::nullopt;
  if (viscosity) t.refuse("material", "either a material or a viscosity, not both");
  if (materials_.empty()) t.refuse("material", "the name of a [[material]], of which there is none");
  std::vector<std::string_view> names;
  for (const Material& material : materials_) names.push_back(material.name);
  return materials_[t.place("material", names)];
}

std::optional<std::size_t> Fluids::find(const Material& material) const {
  for (std::size_t fluid = 0; fluid < options_.fluids(); ++fluid) {
    const bool by_name = by_name_[fluid] != 0;
    if (by_name != material.is_told_by_name()) continue;
    const bool same_numbers =
        options_.viscosity(fluid) == material.viscosity && options_.rest_density(fluid) == material.density;
    if (by_name ? names_[fluid] == material.name : same_numbers) return fluid;
  }
  return std::nullopt;
}

bool Fluids::read_first(TomlTable& t) {
  const std::optional<Material> material = stated(t);
  if (!material) return false;
  options_.kinematic_viscosity = material->viscosity;
  options_.density = material->density;
  add(*material);
  return true;
}

/// But for its viscosity and density, which are there.
void Fluids::add(const Material& material) {
  options_.rheologies.push_back(material.law);
  options_.temperature_laws.push_back(material.temperature_law);
  if (options_.heat) options_.heat->fluids.push_back(material.heat.value_or(*usual_heat_));
  names_.push_back(material.name);
  by_name_.push_back(material.is_told_by_name());
}

std::uint8_t Fluids::number_of(const Material& material, const TomlTable& t) {
  if (const auto known = find(material)) return static_cast<std::uint8_t>(*known);
  if (options_.fluids() == kMaxFluids)
    throw InvalidInput(
        t.where(),
        fmt::format("the scene has more than {} different liquids; allowed: at most as many", kMaxFluids));
  options_.more_viscosities.push_back(material.viscosity);
  options_.more_densities.push_back(material.density);
  add(material);
  return static_cast<std::uint8_t>(options_.fluids() - 1);
}

std::uint8_t Fluids::read(TomlTable& t) {
  const std::optional<Material> material = stated(t);
  const std::uint8_t fluid = material ? number_of(*material, t) : std::uint8_t{0};
  const double density = options_.rest_density(fluid);
  for (const std::uint8_t other : in_use_) {
    const auto [least, most] = std::minmax({density, options_.rest_density(other)});
    if (!may_meet(least, most))
      throw InvalidInput(t.where(),
                         fmt::format("liquids of {:.6g} and {:.6g} kg/m3 meet in the scene; allowed: "
                                     "densities that differ by at most {:.6g} times",
                                     least, most, kMostDensityRatio));
  }
  in_use_.push_back(fluid);
  return fluid;
}

void Fluids::finish() {
  if (!in_use_.empty() && std::ranges::count(in_use_, 0) == 0)
    options_.density = options_.rest_density(in_use_.front());
}

}  // namespace kappaflow
