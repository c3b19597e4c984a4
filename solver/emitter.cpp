#include "solver/emitter.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.h"
#include "core/parallel.h"
#include "solver/fluid_particles.h"
#include "solver/viscous_pressure.h"

namespace kappaflow {
namespace {

constexpr double kWhole = 1e-6;          // rounding that a number of cells may have and still count as whole
constexpr double kBirthClearance = 0.6;  // no particle is made nearer than this to another [spacings]
constexpr double kLeastSine = 1e-3;      // of the angle between a rectangle's `up` and the direction

// Layers stand turned against each other by the golden angle [rad]: on top of each other they would part as
// planes when the stream is stretched.
constexpr double kTurn = 2 * std::numbers::pi * (2 - std::numbers::phi);

constexpr double kMostInLayer = 1e6;  // beyond, a layer alone would fill the memory

void require_emitter(bool holds, const std::string& message) {
  if (!holds) throw InvalidInput("emitter: " + message);
}

Vec3 direction_of(const Emitter& emitter) {
  return emitter.direction.normalized();
}

/// Points (first + i step) u + (first' + j step) v with `columns` x `rows` of them about the origin.
std::vector<Vec3> centred_lattice(double columns, double rows, double spacing, const Vec3& u, const Vec3& v) {
  std::vector<Vec3> points;
  for (double j = 0; j < rows; ++j)
    for (double i = 0; i < columns; ++i)
      points.push_back(spacing * ((i - 0.5 * (columns - 1)) * u + (j - 0.5 * (rows - 1)) * v));
  return points;
}

std::vector<Vec3> layer_of(const DiscMouth& disc, const Vec3& direction, double spacing) {
  const Vec3 u = direction.unitOrthogonal(), v = direction.cross(u);
  const double cells = 2 * std::floor(disc.radius / spacing + 0.5);
  std::vector<Vec3> points = centred_lattice(cells, cells, spacing, u, v);
  std::erase_if(points, [&](const Vec3& x) { return x.norm() > disc.radius * (1 + kWhole); });
  return points;
}

std::vector<Vec3> layer_of(const RectangleMouth& mouth, const Vec3& direction, double spacing) {
  const Vec3 u = mouth.up.cross(direction).normalized(), v = direction.cross(u);
  return centred_lattice(std::floor(mouth.width / spacing + kWhole),
                         std::floor(mouth.height / spacing + kWhole), spacing, u, v);
}

/// About the particles in a layer, as a number that cannot overflow.
double layer_size(const DiscMouth& disc, double spacing) {
  return 4 * disc.radius / spacing * disc.radius / spacing;
}
double layer_size(const RectangleMouth& mouth, double spacing) {
  return mouth.width / spacing * mouth.height / spacing;
}

void check_mouth(const DiscMouth& disc, const Vec3&) {
  require_emitter(std::isfinite(disc.radius) && disc.radius > 0,
                  fmt::format("radius = {} m; must be above 0", disc.radius));
}

void check_mouth(const RectangleMouth& mouth, const Vec3& direction) {
  require_emitter(
      std::isfinite(mouth.width) && mouth.width > 0 && std::isfinite(mouth.height) && mouth.height > 0,
      fmt::format("size = {} x {} m; must be above 0", mouth.width, mouth.height));
  require_emitter(mouth.up.allFinite() && mouth.up.cross(direction).norm() > kLeastSine * mouth.up.norm(),
                  "up is parallel to the direction, or zero; must point across it");
}

}  // namespace

std::vector<Vec3> emitter_layer(const Emitter& emitter, double spacing) {
  return std::visit([&](const auto& mouth) { return layer_of(mouth, direction_of(emitter), spacing); },
                    emitter.mouth);
}

double emitted_layers(const Emitter& emitter, double spacing, std::size_t layer_size, double time) {
  if (time < emitter.start) return 0;
  // Layer k is (k + 1/2) spacings behind the first one's face, which is at the mouth at the start; it is made
  // kNozzleLength before the mouth, and those are left out that would be past the middle of the mouth's last
  // cell at the end.
  const double rate = emitter.speed / spacing;
  const double due = std::floor(rate * (time - emitter.start) + kNozzleLength + 0.5);
  const double all = std::floor(rate * (emitter.end - emitter.start) + 0.5);
  const std::size_t limit = emitter.max_particles / layer_size;  // whole layers
  return std::min({due, all, static_cast<double>(limit)});
}

void check_emitter(const Emitter& emitter, double spacing, std::size_t fluids) {
  require_emitter(emitter.position.allFinite(), "its position must be finite");
  require_emitter(emitter.direction.allFinite() && emitter.direction.norm() > 0,
                  "its direction must be finite and not zero");
  require_emitter(std::isfinite(emitter.speed) && emitter.speed > 0,
                  fmt::format("speed = {} m/s; must be above 0", emitter.speed));
  require_emitter(std::isfinite(emitter.start) && emitter.start < emitter.end,
                  fmt::format("start = {} s; must be before end = {} s", emitter.start, emitter.end));
  require_emitter(emitter.fluid < fluids, fmt::format("fluid {}; there are {}", emitter.fluid, fluids));
  std::visit([&](const auto& mouth) { check_mouth(mouth, direction_of(emitter)); }, emitter.mouth);
  const double wanted =
      std::visit([&](const auto& mouth) { return layer_size(mouth, spacing); }, emitter.mouth);
  require_emitter(
      wanted <= kMostInLayer,
      fmt::format("its mouth holds about {:.3g} particles of spacing {} m; must be at most {:.0g}", wanted,
                  spacing, kMostInLayer));
  const std::size_t size = emitter_layer(emitter, spacing).size();
  require_emitter(size > 0,
                  fmt::format("its mouth is too small to hold one particle of spacing {} m", spacing));
  require_emitter(emitted_layers(emitter, spacing, size, std::numeric_limits<double>::infinity()) > 0,
                  fmt::format("it emits nothing: a layer has {} particles, and one takes {:.4g} s", size,
                              spacing / emitter.speed));
}

Emitters::Emitters(const FluidOptions& options) : spacing_(options.spacing) {
  for (const Emitter& emitter : options.emitters) {
    nozzles_.push_back({emitter, emitter_layer(emitter, spacing_)});
    nozzles_.back().turns = std::holds_alternative<DiscMouth>(emitter.mouth) &&
                            is_thick(options.viscosity(emitter.fluid), options);
  }
}

double Emitters::fastest() const {
  double speed = 0;
  for (const Nozzle& nozzle : nozzles_)
    if (!nozzle.done) speed = std::max(speed, nozzle.emitter.speed);
  return speed;
}

void Emitters::release(FluidParticles& particles) const {
  parallel_for(particles.size(), [&](std::size_t i) {
    if (particles.led_by[i] == 0) return;
    const Emitter& emitter = nozzles_[particles.led_by[i] - 1].emitter;
    const Vec3 x = particles.position[i].head<3>().cast<double>();
    if ((x - emitter.position).dot(direction_of(emitter)) >= 0) particles.led_by[i] = 0;
  });
}

bool Emitters::emit_layer(FluidParticles& particles, std::size_t index, double distance) const {
  const Nozzle& nozzle = nozzles_[index];
  const Vec3 direction = direction_of(nozzle.emitter);
  const Vec3 center = nozzle.emitter.position + distance * direction;
  const double clearance = kBirthClearance * spacing_;
  double reach = 0;
  for (const Vec3& x : nozzle.layer) reach = std::max(reach, x.norm());
  std::vector<Vec3> near;
  for (const Vec4f& x : particles.position)
    if (const Vec3 d = x.head<3>().cast<double>() - center; d.norm() < reach + clearance) near.push_back(d);

  const Mat3 turn = Eigen::AngleAxisd(nozzle.turns ? kTurn * nozzle.made : 0, direction).toRotationMatrix();
  const std::size_t before = particles.size();
  for (const Vec3& in_layer : nozzle.layer) {
    const Vec3 x = turn * in_layer;
    if (std::ranges::none_of(near, [&](const Vec3& other) { return (other - x).norm() < clearance; }))
      particles.add(center + x, nozzle.emitter.speed * direction, nozzle.emitter.fluid,
                    static_cast<std::uint8_t>(index + 1), nozzle.emitter.source);
  }
  return particles.size() > before;
}

bool Emitters::emit(FluidParticles& particles, double time) {
  if (nozzles_.empty()) return false;
  release(particles);
  bool any = false;
  for (std::size_t index = 0; index < nozzles_.size(); ++index) {
    Nozzle& nozzle = nozzles_[index];
    const Emitter& e = nozzle.emitter;
    const double due = emitted_layers(e, spacing_, nozzle.layer.size(), time);
    for (; nozzle.made < due; ++nozzle.made) {
      const double behind = (nozzle.made + 0.5) * spacing_;
      any |= emit_layer(particles, index, e.speed * (time - e.start) - behind);
    }
    nozzle.done = nozzle.made >=
                  emitted_layers(e, spacing_, nozzle.layer.size(), std::numeric_limits<double>::infinity());
  }
  return any;
}

}  // namespace kappaflow
