#include "tools/runs/check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

#include "core/errors.h"
#include "scenes/estimate.h"
#include "solver/emitter.h"

namespace kappaflow {
namespace {

std::string vector_text(const Vec3& v) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x(), v.y(), v.z());
}

// How a block, wall or body reads in the summary.
struct ShapeText {
  std::string operator()(const BoxShape& box) const {
    return fmt::format("box from {} to {} m", vector_text(box.lower), vector_text(box.upper));
  }
  std::string operator()(const SphereShape& sphere) const {
    return fmt::format("sphere of radius {:.4g} m at {} m", sphere.radius, vector_text(sphere.center));
  }
  std::string operator()(const CylinderShape& cylinder) const {
    return fmt::format("cylinder of radius {:.4g} m from {} to {} m", cylinder.radius,
                       vector_text(cylinder.from), vector_text(cylinder.to));
  }
  std::string operator()(const BasinShape& basin) const {
    return fmt::format("basin around {} to {} m", vector_text(basin.lower), vector_text(basin.upper));
  }
  std::string operator()(const StairsShape& stairs) const {
    return fmt::format("stairs, {} steps of rise {:.4g} m and run {:.4g} m, width {:.4g} m", stairs.steps,
                       stairs.rise, stairs.run, stairs.width);
  }
  std::string operator()(const MeshShape& mesh) const { return fmt::format("mesh {}", mesh.file.string()); }
};

struct ReferenceTemperature {
  std::optional<double> operator()(std::monostate) const { return std::nullopt; }
  std::optional<double> operator()(const auto& law) const { return law.reference_temperature; }
};

std::string material_text(std::size_t number, const Scene& scene) {
  const std::string& material = scene.materials[number];
  const bool newtonian = is_newtonian(scene.fluid.rheology(number));
  const std::optional<double> reference =
      std::visit(ReferenceTemperature(), scene.fluid.temperature_law(number));
  return fmt::format("{}, density {:.6g} kg/m3, kinematic viscosity {:.4g} m2/s{}{}",
                     material.empty() ? "" : fmt::format(", material {}", material),
                     scene.fluid.rest_density(number), scene.fluid.viscosity(number),
                     newtonian ? "" : " at rest", reference ? fmt::format(" at {:.5g} K", *reference) : "");
}

std::string temperature_text(const std::optional<double>& temperature) {
  return temperature ? fmt::format(", at {:.5g} K", *temperature) : "";
}

std::string heat_text(const WallHeat& heat) {
  if (heat.kind == WallHeat::Kind::temperature) return temperature_text(heat.value);
  return heat.kind == WallHeat::Kind::flux ? fmt::format(", heat flux {:.5g} W/m2", heat.value) : "";
}

std::string heat_line(const std::optional<HeatOptions>& heat) {
  if (!heat) return "";
  const std::string air = heat->cools()
                              ? fmt::format("air at {:.5g} K, convection {:.4g} W/(m2 K), emissivity {:.4g}",
                                            heat->ambient_temperature, heat->convection, heat->emissivity)
                              : "none lost to the air";
  return fmt::format("  heat      liquid at {:.5g} K, {}\n", heat->temperature, air);
}

/// Of a fluid that is not the scene's first.
std::string other_material_text(std::uint8_t number, const Scene& scene) {
  return number == 0 ? "" : material_text(number, scene);
}

/// Times `factor`: from the least to the most where it changes.
std::string speed_text(const Emitter& emitter, double factor) {
  if (emitter.ramp.empty()) return fmt::format("{:.4g}", factor * emitter.speed);
  const auto [least, most] = std::ranges::minmax(emitter.ramp.keys, {}, &TimeTable<double>::Key::value);
  return fmt::format("{:.4g} to {:.4g}", factor * least.value, factor * most.value);
}

std::string emitter_line(const Emitter& emitter, const Scene& scene) {
  const FluidOptions& fluid = scene.fluid;
  const double layer = static_cast<double>(emitter_layer(emitter, fluid.spacing).size());
  return fmt::format("    emitter at {} m, {} m/s towards {}, {} m3/s ({} particles a layer){}{}{}{}\n",
                     vector_text(emitter.position), speed_text(emitter, 1),
                     vector_text(emitter.direction.normalized()),
                     speed_text(emitter, layer * fluid.spacing * fluid.spacing), layer,
                     emitter.profile == FlowProfile::parabolic ? ", parabolic profile" : "",
                     emitter.motion.at_rest() ? "" : ", moving", other_material_text(emitter.fluid, scene),
                     temperature_text(emitter.temperature));
}

std::string gravity_line(const FluidOptions& fluid) {
  const auto& keys = fluid.gravity_table.keys;
  if (keys.empty()) return "";
  std::vector<std::string> values;
  values.reserve(keys.size());
  for (const auto& [time, gravity] : keys)
    values.push_back(fmt::format("{} at {:.4g} s", vector_text(gravity), time));
  return fmt::format("    gravity {} m/s2\n", fmt::join(values, ", "));
}

std::string body_line(const SceneBody& body, double mass) {
  return fmt::format(
      "    body    {}, {:.4g} kg{}, friction {:.4g}{}{}\n", std::visit(ShapeText(), body.shape), mass,
      body.density ? fmt::format(" ({:.6g} kg/m3)", *body.density) : "", body.friction,
      body.velocity.isZero() && body.angular_velocity.isZero() ? "" : ", moving", heat_text(body.heat));
}

std::string liquid_lines(const PreparedScene& prepared) {
  const Scene& scene = prepared.scene;
  const FluidOptions& fluid = scene.fluid;
  std::string text = fmt::format("  liquid    spacing {:.4g} m{}\n", fluid.spacing, material_text(0, scene));
  text += gravity_line(fluid);
  for (const FluidBlock& block : scene.blocks)
    text += fmt::format("    block   {}, moving at {} m/s{}{}\n", std::visit(ShapeText(), block.shape),
                        vector_text(block.velocity), other_material_text(block.fluid, scene),
                        temperature_text(block.temperature));
  for (const Emitter& emitter : scene.fluid.emitters) text += emitter_line(emitter, scene);
  for (std::size_t w = 0; w < scene.walls.size(); ++w)
    text += fmt::format("    wall    {}{}{}\n", std::visit(ShapeText(), scene.walls[w].shape),
                        scene.walls[w].motion.at_rest() ? "" : ", moving",
                        fluid.heat ? heat_text(fluid.heat->walls[w]) : "");
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    text += body_line(scene.bodies[b], prepared.bodies[b].mass);
  for (const Outflow& outflow : fluid.outflows)
    text += fmt::format("    outflow {}\n", std::visit(ShapeText(), outflow.shape));
  return text + heat_line(fluid.heat);
}

std::string surface_line(const SurfaceDescription& surface, double spacing) {
  return fmt::format("  surface   sigma {:.4g} m, threshold {}, edges {:.4g} m, methods {}\n",
                     surface.sigma * spacing,
                     surface.threshold ? fmt::format("{:.6g}", *surface.threshold) : "auto",
                     surface.edge_length * surface.sigma * spacing, fmt::join(surface.methods, ", "));
}

std::string duration_text(double seconds) {
  if (seconds < 10) return fmt::format("{:.1f} s", seconds);
  if (seconds < 120) return fmt::format("{:.0f} s", seconds);
  return seconds < 7200 ? fmt::format("{:.0f} min", seconds / 60) : fmt::format("{:.1f} h", seconds / 3600);
}

}  // namespace

std::string check_text(const PreparedScene& prepared, int threads) {
  const Scene& scene = prepared.scene;
  const SceneEstimate cost = estimate(prepared, threads);
  const char* const about = scene.fluid.outflows.empty() ? "about" : "at most about";
  return fmt::format("{}: {}\n", scene.file.string(), scene.title) +
         fmt::format("  duration  {:.4g} s, {:.4g} frames per second\n", scene.duration,
                     scene.output.frames_per_second) +
         liquid_lines(prepared) + surface_line(scene.surface, scene.fluid.spacing) +
         fmt::format(
             "  particles {}{}\n  boundary particles {}\n  memory    {} {:.0f} MB\n"
             "  time      about {} on {} thread{}\n",
             cost.particles, cost.emitted > 0 ? fmt::format(", and {} from emitters", cost.emitted) : "",
             cost.boundary_particles, about, std::ceil(static_cast<double>(cost.memory_bytes) / 1e6),
             duration_text(cost.seconds), threads, threads == 1 ? "" : "s");
}

bool has_room(const Scene& scene, std::size_t needed, std::size_t available) {
  if (!scene.fluid.outflows.empty()) return true;  // the estimate does not know what they take
  return needed <= available;
}

void require_memory(const Scene& scene, std::size_t needed, std::size_t available) {
  if (!has_room(scene, needed, available))
    throw InvalidInput(fmt::format(
        "{}: needs about {:.3g} GB of memory, there are {:.3g} GB; a larger "
        "[fluid] spacing needs less",
        scene.file.string(), static_cast<double>(needed) / 1e9, static_cast<double>(available) / 1e9));
}

}  // namespace kappaflow
