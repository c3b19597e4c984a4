#include "solver/start.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "solver/emitter.h"
#include "solver/outflow.h"
#include "solver/surface_tension.h"

namespace kappaflow {
namespace {

void require_fluid(bool holds, const std::string& message) {
  if (!holds) throw InvalidInput("fluid: " + message);
}

void require_positive(double value, const char* name) {
  require_fluid(std::isfinite(value) && value > 0,
                fmt::format("{} = {}; must be greater than 0", name, value));
}

void require_not_negative(double value, const char* name) {
  require_fluid(std::isfinite(value) && value >= 0,
                fmt::format("{} = {}; must be 0 or greater", name, value));
}

void check_densities(const FluidOptions& o) {
  require_fluid(o.more_densities.size() < o.fluids(),
                fmt::format("densities of {} further fluids; there are {}", o.more_densities.size(),
                            o.more_viscosities.size()));
  for (const double density : o.more_densities) require_positive(density, "density of a further fluid");
  const double least = o.least_density(), most = o.largest_density();
  require_fluid(may_meet(least, most),
                fmt::format("densities of {} and {} kg/m3; must differ by at most {} times", most, least,
                            kMostDensityRatio));
}

void check_heat(const HeatOptions& heat, std::size_t fluids) {
  require_positive(heat.temperature, "temperature");
  require_positive(heat.ambient_temperature, "ambient temperature");
  require_not_negative(heat.convection, "convection");
  require_fluid(heat.emissivity >= 0 && heat.emissivity <= 1,
                fmt::format("emissivity = {}; must be from 0 to 1", heat.emissivity));
  require_fluid(heat.fluids.size() == fluids,
                fmt::format("heat properties of {} fluids; there are {}", heat.fluids.size(), fluids));
  for (const HeatProperties& fluid : heat.fluids) {
    require_positive(fluid.specific_heat, "specific heat");
    require_not_negative(fluid.conductivity, "conductivity");
  }
  for (const WallHeat& wall : heat.walls) {
    require_fluid(std::isfinite(wall.value), "a wall's temperature or flux must be finite");
    if (wall.kind == WallHeat::Kind::temperature) require_positive(wall.value, "a wall's temperature");
  }
}

}  // namespace

void check_options(const FluidOptions& o) {
  require_positive(o.spacing, "spacing");
  require_positive(o.density, "density");
  require_not_negative(o.kinematic_viscosity, "kinematic_viscosity");
  require_fluid(o.slip_length >= 0, fmt::format("slip_length = {}; must be 0 or greater", o.slip_length));
  require_fluid(o.fluids() <= 256, fmt::format("{} fluids; allowed: 256", o.fluids()));
  for (const double viscosity : o.more_viscosities)
    require_not_negative(viscosity, "kinematic viscosity of a further fluid");
  check_densities(o);
  require_fluid(o.rheologies.size() <= o.fluids(),
                fmt::format("{} rheologies of {} fluids", o.rheologies.size(), o.fluids()));
  for (const Rheology& law : o.rheologies) check_rheology(law);
  require_fluid(o.temperature_laws.size() <= o.fluids(),
                fmt::format("{} temperature laws of {} fluids", o.temperature_laws.size(), o.fluids()));
  for (const TemperatureLaw& law : o.temperature_laws) {
    check_temperature_law(law);
    require_fluid(o.heat || !has_temperature_law(law), "a temperature law without heat");
  }
  if (o.heat) check_heat(*o.heat, o.fluids());
  for (const Emitter& emitter : o.emitters)
    if (emitter.temperature) require_positive(*emitter.temperature, "temperature of an emitter");
  require_fluid(o.emitters.size() < 256, fmt::format("{} emitters; allowed: 255", o.emitters.size()));
  for (const Emitter& emitter : o.emitters) check_emitter(emitter, o.spacing, o.fluids());
  require_fluid(o.outflows.size() < 256, fmt::format("{} outflows; allowed: 255", o.outflows.size()));
  for (const Outflow& outflow : o.outflows) check_outflow(outflow);
  require_not_negative(o.surface_tension, "surface_tension");
  const double capillary = capillary_time_step(o.surface_tension, o.least_density(), o.spacing);
  require_fluid(
      capillary >= o.min_time_step,
      fmt::format("surface_tension = {} N/m needs time steps of {:.3g} s, below min_time_step = {:.3g} s",
                  o.surface_tension, capillary, o.min_time_step));
  require_fluid(o.gravity.allFinite(), "gravity must be finite");
  require_fluid(o.gravity_table.ascends(), "the times of gravity must ascend");
  for (const auto& [time, gravity] : o.gravity_table.keys)
    require_fluid(gravity.allFinite(), fmt::format("gravity at {} s must be finite", time));
  require_positive(o.cfl, "cfl");
  require_positive(o.min_time_step, "min_time_step");
  require_positive(o.max_time_step, "max_time_step");
  require_fluid(o.min_time_step <= o.max_time_step,
                fmt::format("min_time_step = {}; must not exceed max_time_step = {}", o.min_time_step,
                            o.max_time_step));
  require_positive(o.density_tolerance, "density_tolerance");
  require_positive(o.divergence_tolerance, "divergence_tolerance");
  require_positive(o.viscosity_tolerance, "viscosity_tolerance");
  require_positive(o.max_pressure_iterations, "max_pressure_iterations");
  require_positive(o.max_viscosity_iterations, "max_viscosity_iterations");
}

void check_start(std::span<const Vec3> position, std::span<const Vec3> velocity,
                 std::span<const std::uint8_t> fluid, std::size_t fluids, std::span<const int> source,
                 std::span<const SolidWall> walls) {
  require_fluid(position.size() == velocity.size(),
                fmt::format("{} positions but {} velocities", position.size(), velocity.size()));
  require_fluid(fluid.empty() || fluid.size() == position.size(),
                fmt::format("{} positions but fluids of {} particles", position.size(), fluid.size()));
  require_fluid(source.empty() || source.size() == position.size(),
                fmt::format("{} positions but sources of {} particles", position.size(), source.size()));
  for (const std::uint8_t index : fluid)
    require_fluid(index < fluids, fmt::format("a particle is of fluid {}; there are {}", index, fluids));
  for (std::size_t i = 0; i < position.size(); ++i) {
    const Vec3& x = position[i];
    require_fluid(x.allFinite() && velocity[i].allFinite(),
                  fmt::format("the position or velocity of particle {} is not finite", i));
    require_fluid(
        nearest_of_walls(walls, x).distance >= 0,
        fmt::format("particle {} at ({:.6g}, {:.6g}, {:.6g}) is inside a wall", i, x.x(), x.y(), x.z()));
  }
}

void check_temperatures(std::span<const double> temperature, std::size_t particles,
                        const FluidOptions& options) {
  if (temperature.empty()) return;
  require_fluid(options.heat.has_value(), "temperatures of particles without heat");
  require_fluid(temperature.size() == particles,
                fmt::format("{} positions but {} temperatures", particles, temperature.size()));
  for (const double value : temperature) require_positive(value, "temperature of a particle");
}

std::vector<float> masses_of_fluids(const FluidOptions& options) {
  std::vector<float> masses;
  for (std::size_t fluid = 0; fluid < options.fluids(); ++fluid)
    masses.push_back(static_cast<float>(options.relative_mass(fluid)));
  if (std::ranges::count(masses, 1.0f) == std::ssize(masses)) masses.clear();
  return masses;
}

FluidParticles particles_at_start(std::span<const Vec3> position, std::span<const Vec3> velocity,
                                  std::span<const std::uint8_t> fluid, std::span<const int> source) {
  FluidParticles particles;
  // Of all ranks' particles: growing would take up to the double.
  FluidParticles::for_state(false, [&](auto member) { (particles.*member).reserve(position.size()); });
  for (std::size_t i = 0; i < position.size(); ++i)
    particles.add(position[i], velocity[i], fluid.empty() ? std::uint8_t{0} : fluid[i], 0,
                  source.empty() ? 0 : source[i]);
  return particles;
}

}  // namespace kappaflow
