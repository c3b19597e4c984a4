#include "solver/emitter.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/errors.h"
#include "core/parallel.h"
#include "solver/fluid_particles.h"
#include "solver/halo.h"
#include "solver/viscous_pressure.h"

namespace kappaflow {
namespace {

constexpr double kWhole = 1e-6;          // rounding that a number of cells may have and still count as whole
constexpr double kBirthClearance = 0.6;  // no particle is made nearer than this to another [spacings]
constexpr double kLeastSine = 1e-3;      // of the angle between a rectangle's `up` and the direction

// Layers stand turned against each other by the golden angle [rad]: on top of each other they would part as
// planes when the stream is stretched.
constexpr double kTurn = 2 * std::numbers::pi * (2 - std::numbers::phi);

constexpr double kReserve = kNozzleLength + 0.5;  // layers that are made before they have reached the mouth
constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr double kStanding = 1e-6;    // share of the mean speed below which liquid stands still
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
  const auto [u, v] = sides_of(mouth, direction);
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

void check_speed(const Emitter& emitter) {
  if (emitter.ramp.empty()) {
    require_emitter(std::isfinite(emitter.speed) && emitter.speed > 0,
                    fmt::format("speed = {} m/s; must be above 0", emitter.speed));
    return;
  }
  require_emitter(emitter.ramp.ascends(), "the times of its speeds must ascend");
  for (const auto& [time, speed] : emitter.ramp.keys)
    require_emitter(std::isfinite(speed) && speed >= 0,
                    fmt::format("speed = {} m/s at {} s; must be 0 or above", speed, time));
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
  const double due = std::floor(way_of_stream(emitter, spacing, time) + kReserve);
  const double all = std::floor(way_of_stream(emitter, spacing, emitter.end) + 0.5);
  const std::size_t limit = emitter.max_particles / layer_size;  // whole layers
  return std::min({due, all, static_cast<double>(limit)});
}

void check_emitter(const Emitter& emitter, double spacing, std::size_t fluids) {
  require_emitter(emitter.position.allFinite(), "its position must be finite");
  require_emitter(emitter.direction.allFinite() && emitter.direction.norm() > 0,
                  "its direction must be finite and not zero");
  check_speed(emitter);
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
  require_emitter(emitted_layers(emitter, spacing, size, kForever) > 0,
                  fmt::format("it emits nothing: a layer has {} particles, and one takes {:.4g} s", size,
                              spacing / emitter.largest_speed(emitter.start, emitter.end)));
}

Emitters::Nozzle::Nozzle(const Emitter& of, const FluidOptions& options)
    : emitter(of),
      direction(direction_of(of)),
      layer(emitter_layer(of, options.spacing)),
      layer_size(layer.size()),
      profile(of, layer),
      spacing(options.spacing) {
  // With a profile, columns pass each other, and nothing parts as planes.
  turns = std::holds_alternative<DiscMouth>(of.mouth) && of.profile == FlowProfile::uniform &&
          is_thick(options.viscosity(of.fluid), options);
  std::erase_if(layer, [this](const Vec3& x) { return profile.at(x) < kStanding; });
  reach = 0;
  for (const Vec3& x : layer) reach = std::max(reach, x.norm());
}

/// Layers of the mean stream that are due at `time`, and with a profile the share of the next one.
double Emitters::Nozzle::layers_due(double time) const {
  if (time < emitter.start) return 0;
  if (emitter.profile == FlowProfile::uniform) return emitted_layers(emitter, spacing, layer_size, time);
  return way_of_stream(emitter, spacing, time) + kReserve;
}

/// Particles of a column that have been made when so many layers of the mean stream are due: as
/// emitted_layers(), with the column's own way.
double Emitters::Nozzle::columns_made(double share, double layers) const {
  if (!(layers > 0)) return 0;
  const double due = std::floor(share * (layers - kReserve) + kReserve);
  const double all = std::floor(share * way_of_stream(emitter, spacing, emitter.end) + 0.5);
  const std::size_t limit = emitter.max_particles / layer_size;  // whole layers
  return std::min({due, all, std::floor(share * static_cast<double>(limit))});
}

Emitters::Emitters(const FluidOptions& options) {
  for (const Emitter& emitter : options.emitters) nozzles_.emplace_back(emitter, options);
}

double Emitters::fastest(double t0, double t1) const {
  double speed = 0;
  for (const Nozzle& nozzle : nozzles_) {
    const Emitter& e = nozzle.emitter;
    if (nozzle.done && e.motion.at_rest()) continue;  // else its last layers may still be led
    const double flow = nozzle.profile.largest() * e.largest_speed(t0, t1);
    const auto of_mouth = [&](double time) {
      const RigidVelocity v = e.motion.velocity(time);
      return v.at(e.motion.pose(time) * e.position).norm() +
             v.angular.norm() * (nozzle.reach + kNozzleLength * nozzle.spacing);
    };
    if (!e.motion.at_rest()) {
      double mouth = std::max(of_mouth(t0), of_mouth(t1));
      for (const BodyMotion::Key& key : e.motion.keys)
        if (key.time > t0 && key.time < t1) mouth = std::max(mouth, of_mouth(key.time));
      speed = std::max(speed, flow + mouth);
    }
    speed = std::max(speed, flow);
  }
  return speed;
}

void Emitters::lead(FluidParticles& particles, double time, double time_step) {
  if (std::ranges::all_of(nozzles_, &Nozzle::is_steady)) return;
  for (Nozzle& nozzle : nozzles_) {
    nozzle.from = nozzle.emitter.motion.pose(time);
    nozzle.to = nozzle.emitter.motion.pose(time + time_step);
    nozzle.way = time_step * nozzle.emitter.mean_speed(time, time + time_step);
  }
  parallel_for(particles.size(), [&](std::size_t i) {
    if (particles.led_by[i] == 0) return;
    const Nozzle& nozzle = nozzles_[particles.led_by[i] - 1];
    if (nozzle.is_steady()) return;
    const Vec3 x = particles.position[i].head<3>().cast<double>(), rest = nozzle.from.inverse(x);
    const Vec3 beside = rest - nozzle.emitter.position,
               across = beside - beside.dot(nozzle.direction) * nozzle.direction;
    const Vec3 next = nozzle.to * (rest + nozzle.way * nozzle.profile.at(across) * nozzle.direction);
    particles.velocity[i] = padded((next - x) / time_step);
  });
}

void Emitters::release(FluidParticles& particles, double time) {
  for (Nozzle& nozzle : nozzles_) nozzle.to = nozzle.emitter.motion.pose(time);
  parallel_for(particles.size(), [&](std::size_t i) {
    if (particles.led_by[i] == 0) return;
    const Nozzle& nozzle = nozzles_[particles.led_by[i] - 1];
    const Vec3 x = nozzle.to.inverse(particles.position[i].head<3>().cast<double>());
    if ((x - nozzle.emitter.position).dot(nozzle.direction) >= 0) particles.led_by[i] = 0;
  });
}

/// Fills due_ with what is to be made until so many layers are; way: that the mean stream has gone [m].
void Emitters::collect_due(const Nozzle& nozzle, double layers, double way) {
  const Vec3 &mouth = nozzle.emitter.position, &direction = nozzle.direction;
  due_.clear();
  if (nozzle.emitter.profile == FlowProfile::uniform) {
    for (double k = nozzle.made; k < layers; ++k) {
      const Vec3 center = mouth + (way - (k + 0.5) * nozzle.spacing) * direction;
      const Mat3 turn = Eigen::AngleAxisd(nozzle.turns ? kTurn * k : 0, direction).toRotationMatrix();
      for (const Vec3& x : nozzle.layer) due_.push_back(center + turn * x);
    }
    return;
  }
  for (const Vec3& x : nozzle.layer) {
    const double share = nozzle.profile.at(x), made = nozzle.columns_made(share, layers);
    for (double k = nozzle.columns_made(share, nozzle.made); k < made; ++k)
      due_.push_back(mouth + (share * way - (k + 0.5) * nozzle.spacing) * direction + x);
  }
}

/// Makes particles of due_ where there is no liquid; returns whether any. Of several ranks the first makes
/// them, and they then go to where they belong.
bool Emitters::add_due(FluidParticles& particles, std::size_t index, double time) {
  const Nozzle& nozzle = nozzles_[index];
  const Emitter& e = nozzle.emitter;
  const RigidPose& pose = nozzle.to;
  const RigidVelocity moving = e.motion.velocity(time);
  const double clearance = kBirthClearance * nozzle.spacing, speed = e.speed_at(time);
  const Vec3 mouth = pose * e.position, direction = pose.rotation * nozzle.direction;
  double reach = 0;
  for (const Vec3& x : due_) reach = std::max(reach, (x - e.position).norm());
  near_.clear();
  for (const Vec4f& p : particles.position)
    if (const Vec3 x = p.head<3>().cast<double>(); (x - mouth).norm() < reach + clearance) near_.push_back(x);
  if (particles.halo != nullptr) near_ = particles.halo->ranks().gathered(near_);

  const std::uint64_t before = particles.made;
  for (const Vec3& rest : due_) {
    const Vec3 x = pose * rest, beside = rest - e.position;
    if (std::ranges::any_of(near_, [&](const Vec3& other) { return (other - x).norm() < clearance; }))
      continue;
    const Vec3 across = beside - beside.dot(nozzle.direction) * nozzle.direction;
    const Vec3 v = nozzle.profile.at(across) * speed * direction + moving.at(x);
    if (is_first_rank(particles))
      particles.add(x, v, e.fluid, static_cast<std::uint8_t>(index + 1), e.source);
    else
      ++particles.made;
  }
  return particles.made > before;
}

bool Emitters::emit(FluidParticles& particles, double time) {
  if (nozzles_.empty()) return false;
  release(particles, time);
  bool any = false;
  for (std::size_t index = 0; index < nozzles_.size(); ++index) {
    Nozzle& nozzle = nozzles_[index];
    const Emitter& e = nozzle.emitter;
    const double layers = nozzle.layers_due(time);
    if (layers > nozzle.made) {
      collect_due(nozzle, layers, way_of_stream(e, 1, time));
      if (!due_.empty()) any |= add_due(particles, index, time);
      nozzle.made = layers;
    }
    const double all = emitted_layers(e, nozzle.spacing, nozzle.layer_size, kForever);
    nozzle.done = layers >= (e.profile == FlowProfile::uniform ? all : all + kReserve);
  }
  return any;
}

}  // namespace kappaflow
