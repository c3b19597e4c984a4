// What the solver is told: the liquid, its emitters, and how to step.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <variant>
#include <vector>

#include "core/body_motion.h"
#include "core/shapes.h"
#include "core/time_table.h"
#include "core/types.h"
#include "solver/heat_options.h"
#include "solver/rheology.h"
#include "solver/temperature_law.h"

namespace kappaflow {

/// The round mouth of an emitter.
struct DiscMouth {
  double radius = 0;  ///< [m]
};
/// The rectangular mouth of an emitter.
struct RectangleMouth {
  double width = 0, height = 0;  ///< [m]
  Vec3 up{0, 1, 0};              ///< its part across the emitter's direction is that of `height`
};

/// How fast the liquid is across a mouth.
enum class FlowProfile {
  uniform,    ///< as fast everywhere
  parabolic,  ///< as developed flow in a pipe of that section: see SpeedProfile in emitter_flow.h
};

/// A mouth that liquid leaves. Particles come in layers of a square lattice, one layer every spacing / speed
/// seconds, or with a profile each column of them in its own time, so that the stream has rest density from
/// the mouth on. The last kNozzleLength (emitter.h) before the mouth they are led: they move as the emitter
/// says whatever pushes them, so that the liquid in front of the mouth has liquid behind it.
struct Emitter {
  std::variant<DiscMouth, RectangleMouth> mouth;
  Vec3 position{0, 0, 0};    ///< centre of the mouth, at t = 0 [m]
  Vec3 direction{0, -1, 0};  ///< of the flow, at t = 0; any length above 0
  double speed = 0;          ///< mean over the mouth, > 0 [m/s]
  TimeTable<double> ramp;    ///< unless empty, in place of speed, >= 0 [m/s]
  FlowProfile profile = FlowProfile::uniform;
  BodyMotion motion;  ///< of the mouth; what flows out has its velocity too
  double start = 0;   ///< when the first layer is at the mouth [s]
  double end = std::numeric_limits<double>::infinity();                 ///< when the last one has left it [s]
  std::size_t max_particles = std::numeric_limits<std::size_t>::max();  ///< whole layers within this limit
  std::uint8_t fluid = 0;                                               ///< which fluid, see FluidOptions
  int source = 0;                                                       ///< of its particles
  std::optional<double> temperature;  ///< of its liquid, where there is heat; else that of HeatOptions [K]

  double speed_at(double time) const { return ramp.empty() ? speed : ramp.at(time); }  ///< [m/s]
  /// Over [t0, t1] [m/s].
  double mean_speed(double t0, double t1) const { return ramp.empty() ? speed : ramp.mean(t0, t1); }
  double largest_speed(double t0, double t1) const { return ramp.empty() ? speed : ramp.largest(t0, t1); }
};

/// A region that takes away the particles whose centres are in it.
struct Outflow {
  std::variant<BoxShape, SphereShape, CylinderShape> shape;
};

/// The largest ratio of the rest densities of two fluids. See docs/materials.md.
constexpr double kMostDensityRatio = 100;
/// Whether two densities are within that of each other, but for rounding.
inline bool may_meet(double least, double most) {
  return most <= kMostDensityRatio * least * (1 + 1e-9);
}

/// Options of the solver; SI units.
struct FluidOptions {
  double spacing = 0;     ///< rest distance of neighbouring particles [m]; the kernel's support is twice it
  double density = 1000;  ///< rest density of fluid 0 [kg/m3]
  double kinematic_viscosity = 1;  ///< [m2/s]
  double slip_length = 0;          ///< of the walls (Navier): 0: no slip, infinite: free slip [m]
  /// Kinematic viscosities of fluids 1, 2, ... where there are several [m2/s]. Between fluids of dynamic
  /// viscosities a and b the viscosity is their harmonic mean, 2 a b / (a + b): the shear stress across the
  /// interface is then continuous.
  std::vector<double> more_viscosities;
  /// Rest densities of fluids 1, 2, ..., as far as it goes; the others have that of fluid 0 [kg/m3]. At most
  /// kMostDensityRatio between any two.
  std::vector<double> more_densities;
  /// Of fluids 0, 1, ..., as far as it goes: the laws of those that are not Newtonian, in place of their
  /// viscosities above.
  std::vector<Rheology> rheologies;
  /// Likewise, where there is heat: of those whose viscosity depends on the temperature T. It is a(T) nu(a(T)
  /// g) at the shear rate g, with nu(g) the viscosity above, that at the reference temperature: the stress is
  /// a function of a(T) g (the superposition of time and temperature of Ferry, 1950).
  std::vector<TemperatureLaw> temperature_laws;
  std::optional<HeatOptions> heat;  ///< without it nothing has a temperature
  std::vector<Emitter> emitters;
  std::vector<Outflow> outflows;
  double surface_tension = 0;  ///< of all fluids against the air [N/m]; see surface_tension.h
  Vec3 gravity{0, -9.81, 0};   ///< [m/s2]
  /// Unless empty, gravity in time [m/s2]; `gravity` is then that at t = 0.
  TimeTable<Vec3> gravity_table;

  double cfl = 0.4;             ///< a step moves no particle further than cfl * spacing
  double min_time_step = 1e-6;  ///< [s]; a flow that needs less is a SolverFailure
  double max_time_step = 5e-3;  ///< [s]

  double density_tolerance = 1e-4;     ///< mean compression at which the pressure solver stops [1]
  double divergence_tolerance = 1e-3;  ///< mean rate of compression times the time step, likewise [1]
  int max_pressure_iterations = 100;
  double viscosity_tolerance = 1e-2;  ///< of the velocities' error, at which viscosity stops: viscosity.h [1]
  int max_viscosity_iterations = 100;

  /// gravity_table, or one for the constant `gravity`.
  TimeTable<Vec3> gravity_in_time() const {
    return gravity_table.empty() ? TimeTable<Vec3>{{{0, gravity}}} : gravity_table;
  }
  std::size_t fluids() const { return 1 + more_viscosities.size(); }
  /// Of fluid 0, 1, ... [kg/m3]
  double rest_density(std::size_t fluid) const {
    return fluid == 0 || fluid > more_densities.size() ? density : more_densities[fluid - 1];
  }
  double least_density() const {
    return more_densities.empty() ? density : std::min(density, std::ranges::min(more_densities));
  }
  double largest_density() const {
    return more_densities.empty() ? density : std::max(density, std::ranges::max(more_densities));
  }
  /// Of fluid 0, 1, ...: the mass of a particle over that of fluid 0 [1].
  double relative_mass(std::size_t fluid) const { return rest_density(fluid) / density; }
  /// Of fluid 0, 1, ...
  Rheology rheology(std::size_t fluid) const {
    return fluid < rheologies.size() ? rheologies[fluid] : Rheology();
  }
  TemperatureLaw temperature_law(std::size_t fluid) const {
    return fluid < temperature_laws.size() ? temperature_laws[fluid] : TemperatureLaw();
  }
  /// Kinematic, of fluid 0, 1, ..., of one that is not Newtonian at rest, of one that depends on the
  /// temperature at its reference temperature [m2/s].
  double viscosity(std::size_t fluid) const {
    if (!is_newtonian(rheology(fluid))) return viscosity_at(rheologies[fluid], 0);
    return fluid == 0 ? kinematic_viscosity : more_viscosities[fluid - 1];
  }
};

}  // namespace kappaflow
