#include "solver/start.h"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "core/errors.h"

namespace kappaflow {
namespace {

void require(bool holds, const std::string& message) {
  if (!holds) throw InvalidInput("fluid: " + message);
}

void require_positive(double value, const char* name) {
  require(std::isfinite(value) && value > 0, fmt::format("{} = {}; must be greater than 0", name, value));
}

void require_not_negative(double value, const char* name) {
  require(std::isfinite(value) && value >= 0, fmt::format("{} = {}; must be 0 or greater", name, value));
}

}  // namespace

void check_options(const FluidOptions& o) {
  require_positive(o.spacing, "spacing");
  require_positive(o.density, "density");
  require_not_negative(o.kinematic_viscosity, "kinematic_viscosity");
  require(o.slip_length >= 0, fmt::format("slip_length = {}; must be 0 or greater", o.slip_length));
  require(o.gravity.allFinite(), "gravity must be finite");
  require_positive(o.cfl, "cfl");
  require_positive(o.min_time_step, "min_time_step");
  require_positive(o.max_time_step, "max_time_step");
  require(o.min_time_step <= o.max_time_step,
          fmt::format("min_time_step = {}; must not exceed max_time_step = {}", o.min_time_step,
                      o.max_time_step));
  require_positive(o.density_tolerance, "density_tolerance");
  require_positive(o.divergence_tolerance, "divergence_tolerance");
  require_positive(o.viscosity_tolerance, "viscosity_tolerance");
  require_positive(o.max_pressure_iterations, "max_pressure_iterations");
  require_positive(o.max_viscosity_iterations, "max_viscosity_iterations");
}

void check_start(std::span<const Vec3> position, std::span<const Vec3> velocity,
                 std::span<const SolidDistance> solids) {
  require(!position.empty(), "there are no particles");
  require(position.size() == velocity.size(),
          fmt::format("{} positions but {} velocities", position.size(), velocity.size()));
  for (std::size_t i = 0; i < position.size(); ++i) {
    const Vec3& x = position[i];
    require(x.allFinite() && velocity[i].allFinite(),
            fmt::format("the position or velocity of particle {} is not finite", i));
    require(nearest_of_union(solids, x).distance >= 0,
            fmt::format("particle {} at ({:.6g}, {:.6g}, {:.6g}) is inside a wall", i, x.x(), x.y(), x.z()));
  }
}

FluidParticles particles_at_start(std::span<const Vec3> position, std::span<const Vec3> velocity) {
  const std::size_t n = position.size();
  FluidParticles particles;
  particles.id.resize(n);
  std::iota(particles.id.begin(), particles.id.end(), 0u);
  for (std::size_t i = 0; i < n; ++i) {
    particles.position.emplace_back(padded(position[i]));
    particles.velocity.emplace_back(padded(velocity[i]));
  }
  particles.viscous_change.assign(n, Vec4f::Zero());
  particles.density_pressure.assign(n, 0);
  particles.divergence_pressure.assign(n, 0);
  return particles;
}

}  // namespace kappaflow
