#include "solver/boundary.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/parallel.h"
#include "solver/halo.h"

namespace kappaflow {
namespace {

/// As Walls::Body holds it.
Vec4f packed(const WallHeat& heat) {
  const float value = static_cast<float>(heat.value);
  if (heat.kind == WallHeat::Kind::temperature) return {1, value, 0, 0};
  return {0, 0, heat.kind == WallHeat::Kind::flux ? value : 0, 0};
}

// Wall particles are this much larger than the liquid's, and stand so much deeper (sample_walls()) that
// liquid at half a spacing from the wall continues a lattice of rest density rho there: with S(y) the sum
// over a plane of particles at the distance y, ratio S(1.44 spacing) = S(spacing). Pressure acts through
// kappa_i + kappa_j between layers of liquid but through kappa_i alone at a wall, so the lattice is in
// balance when the wall's density rises twice as steeply: ratio S'(1.44 spacing) = 2 S'(spacing). Both hold
// for this ratio and that depth. With volumes of the liquid's size the contact layer would be squeezed until
// they do, and its pressure be wrong by as much.
constexpr float kVolumeRatio = 8;

// Smaller distances from a wall's particle are taken for this one, in spacings: friction has no bound.
constexpr float kLeastWallDistance = 1e-3f;

/// Several threads may do so.
void note_wet(char& wet) {
  std::atomic_ref shared(wet);
  if (shared.load(std::memory_order_relaxed) == 0) shared.store(1, std::memory_order_relaxed);
}

/// Sum of the kernel over a square lattice in a plane through one of its points. A wall of such particles
/// with volumes spacing^3 continues a cubic lattice of liquid without a jump in density.
float square_lattice_sum(const CubicSpline& kernel, float spacing) {
  return kernel.value(0) + 4 * kernel.value(spacing) + 4 * kernel.value(spacing * std::sqrt(2.0f));
}

/// The factor c of g = c sum_b V_b / r_ib. The weights have nothing to do with those of the pressure: what
/// matters is the shear stress. Between a wall's surface and liquid at the distance d it is rho nu v / d, and
/// acts on a layer one spacing thick: g = 1 / (spacing d), the finite-volume form. A flat wall's integral of
/// 1/r over the plane y = d + depth below is 2 pi (support - y); c makes it right at the contact distance,
/// whose tangent it nearly is. It vanishes about one spacing from the wall, where the second layer begins.
double friction_factor(double spacing, double support) {
  const double y = (kContactDistance + kWallDepth) * spacing;
  const double volume_of_area = static_cast<double>(kVolumeRatio) * spacing;
  return 1 / (kContactDistance * spacing * spacing * volume_of_area * 2 * std::numbers::pi * (support - y));
}

}  // namespace

/// The sums of one particle over the samples of one body, or of all of them.
struct Walls::Contact {
  bool touches = false;
  float density = 0, friction = 0;
  Vec4f gradient = Vec4f::Zero();
  Vec4f normal = Vec4f::Zero();    // times friction
  Vec4f velocity = Vec4f::Zero();  // times friction; w: see WallSums
  Vec4f heat = Vec4f::Zero();      // of Body times friction

  void operator+=(const Contact& other) {
    touches = touches || other.touches;
    density += other.density;
    friction += other.friction;
    gradient += other.gradient;
    normal += other.normal;
    velocity += other.velocity;
    heat += other.heat;
  }

  WallHeatSum heat_sum() const {
    constexpr float least = std::numeric_limits<float>::min();
    return {heat[0] / std::max(friction, least), heat[1] / std::max(heat[0], least),
            heat[2] / std::max(friction, least)};
  }
};

Walls::Walls(std::span<const WallBody> bodies, float spacing) : spacing_(spacing), kernel_(2 * spacing) {
  friction_scale_ = static_cast<float>(
      friction_factor(static_cast<double>(spacing), static_cast<double>(kernel_.support())));
  for (const WallBody& body : bodies) {
    bodies_.push_back(make_body(body));
    moving_ = moving_ || bodies_.back().moves();
    rigid_ = rigid_ || body.rigid;
    heats_ = heats_ || !body.heat.empty();
  }
  move_to(0);
}

Walls::Body Walls::make_body(const WallBody& wall) const {
  Body body;
  body.motion = wall.motion;
  body.rigid = wall.rigid;
  std::vector<Vec3> points;
  for (const WallSample& sample : wall.samples) {
    points.push_back(sample.position);
    body.reach = std::max(body.reach, (sample.position - wall.motion.point).norm());
  }
  const float support = kernel_.support();
  body.grid.build(std::span<const Vec3>(points), static_cast<double>(support));
  for (const std::uint32_t b : body.grid.order()) {
    body.position.push_back(padded(points[b]));
    body.normal.emplace_back(wall.samples[b].normal.cast<float>());
    if (!wall.heat.empty()) body.heat.push_back(packed(wall.heat[b]));
  }
  const float full = kVolumeRatio * square_lattice_sum(kernel_, spacing_) * spacing_ * spacing_ * spacing_;
  std::vector<float> volume(points.size());
  parallel_for(points.size(), [&](std::size_t b) {
    float sum = 0;  // Akinci et al. 2012, Eq. 4, scaled so that an even layer gets the liquid's volumes
    body.grid.ranges_near(body.position[b], static_cast<double>(support),
                          [&](std::uint32_t begin, std::uint32_t end) {
                            for (std::uint32_t k = begin; k < end; ++k)
                              if (!opposite(body.normal[b].cast<double>(), body.normal[k].cast<double>()))
                                sum += kernel_.value((body.position[b] - body.position[k]).norm());
                          });
    volume[b] = full / sum;
  });
  for (std::size_t b = 0; b < points.size(); ++b) body.position[b][3] = volume[b];
  body.near.resize(body.grid.cells());
  parallel_for(body.near.size(), [&](std::size_t cell) {
    body.grid.ranges_around(static_cast<std::uint32_t>(cell),
                            [&](std::uint32_t, std::uint32_t) { body.near[cell] = true; });
  });
  body.grid.forget_points();
  return body;
}

std::size_t Walls::size() const {
  std::size_t n = 0;
  for (const Body& body : bodies_) n += body.position.size();
  return n;
}

std::size_t Walls::bytes() const {
  std::size_t sum = 0;
  for (const Body& body : bodies_)
    sum += body.grid.bytes() + bytes_of(body.near, body.position, body.normal, body.heat);
  return sum;
}

void Walls::move_to(double time) {
  for (Body& body : bodies_) {
    if (body.rigid) continue;
    body.pose = body.motion.pose(time);
    body.velocity = body.motion.velocity(time);
  }
}

void Walls::place(std::size_t rigid_body, const RigidPose& pose, const RigidVelocity& velocity) {
  for (Body& body : bodies_) {
    if (!body.rigid || rigid_body-- > 0) continue;
    body.pose = pose;
    body.velocity = velocity;
    return;
  }
}

double Walls::fastest() const {
  double speed = 0;
  for (const Body& body : bodies_)
    speed = std::max(speed, body.velocity.linear.norm() + body.velocity.angular.norm() * body.reach);
  return speed;
}

/// Whether a rigid body may be within the support, by the sphere about its centre of mass.
bool Walls::is_near(const Body& body, const Vec4f& x) const {
  const double reach = body.reach + static_cast<double>(kernel_.support());
  const Vec3 centre = body.pose * body.motion.point;
  return (x.head<3>().cast<double>() - centre).squaredNorm() < reach * reach;
}

/// Also notes which samples of a rigid body are wet.
Walls::Contact Walls::contact(Body& body, const Vec4f& x) const {
  const bool moving = body.moves();
  const Vec3 world = x.head<3>().cast<double>();
  const Vec4f rest = moving ? padded(body.pose.inverse(world)) : x;
  const float support = kernel_.support();
  Contact sum;
  const auto cell = body.grid.cell_holding(rest);
  if (cell && !body.near[*cell]) return sum;
  body.grid.ranges_near(rest, static_cast<double>(support), [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t b = begin; b < end; ++b) {
      Vec4f d = rest - body.position[b];
      d[3] = 0;
      const float r2 = d.squaredNorm();
      // Samples that face away are the other side of a thin wall.
      if (r2 >= support * support || d.head<3>().dot(body.normal[b]) < -spacing_) continue;
      const float r = std::sqrt(r2), volume = body.position[b][3];
      const float friction = volume / std::max(r, kLeastWallDistance * spacing_);
      sum.touches = true;
      if (body.rigid) note_wet(body.wet[b]);
      sum.density += volume * kernel_.value(r);
      sum.gradient += volume * kernel_.gradient_factor(r) * d;
      sum.friction += friction;
      sum.normal.head<3>() += friction * body.normal[b];
      if (!body.heat.empty()) sum.heat += friction * body.heat[b];
    }
  });
  if (!moving || !sum.touches) return sum;
  const Eigen::Matrix3f rotation = body.pose.rotation.cast<float>();
  sum.gradient.head<3>() = rotation * sum.gradient.head<3>();
  sum.normal.head<3>() = rotation * sum.normal.head<3>();
  if (body.rigid) return sum;  // its velocity changes within a step
  // A rotation's velocity differs between the particle and a sample by a vector across the line that joins
  // them, along which the kernel's gradient lies: for the density, the particle's place serves as well as the
  // sample's.
  const Vec3 n = sum.normal.head<3>().normalized().cast<double>();
  const Vec3 surface = world - kContactDistance * static_cast<double>(spacing_) * n;
  sum.velocity = sum.friction * padded(body.velocity.at(surface));
  sum.velocity[3] = -padded(body.velocity.at(world)).dot(sum.gradient);
  return sum;
}

void Walls::add_contact(const Contact& sum, std::uint32_t body, std::size_t i, FluidParticles& particles,
                        Found& found) const {
  if (!sum.touches) return;
  particles.density[i] += sum.density;
  particles.gradient_sum[i] += sum.gradient;
  // Between opposite walls the normals cancel, and there is no direction without friction.
  const float length = sum.normal.norm();
  Vec4f f = length > 1e-3f * sum.friction ? Vec4f(sum.normal / length) : Vec4f(Vec4f::Zero());
  f[3] = friction_scale_ * sum.friction;
  found.friction.push_back(f);
  if (heats_) found.heat.push_back(sum.heat_sum());
  if (rigid_) {
    found.body.push_back(body);
    found.gradient.push_back(sum.gradient);
  }
  if (!moving_) return;
  const float rate = sum.velocity[3];
  Vec4f velocity = sum.velocity / std::max(sum.friction, std::numeric_limits<float>::min());
  velocity[3] = rate;
  found.velocity.push_back(velocity);
}

void Walls::add_to_chunk(std::size_t chunk, FluidParticles& particles, WallSums& sums) {
  const std::size_t end = std::min((chunk + 1) * kChunk, particles.size());
  Found& found = found_[chunk];
  found.friction.clear();
  found.velocity.clear();
  found.heat.clear();
  found.body.clear();
  found.gradient.clear();
  for (std::size_t i = chunk * kChunk; i < end; ++i) {
    sums.first[i] = static_cast<std::uint32_t>(found.friction.size());
    const Vec4f x = particles.position[i];
    Contact prescribed;
    for (Body& body : bodies_)
      if (!body.rigid) prescribed += contact(body, x);
    add_contact(prescribed, WallSums::kPrescribed, i, particles, found);
    if (!rigid_) continue;
    std::uint32_t number = 0;
    for (Body& body : bodies_) {
      if (!body.rigid) continue;
      if (is_near(body, x)) add_contact(contact(body, x), number, i, particles, found);
      ++number;
    }
  }
}

double Walls::wet_share(std::size_t rigid_body) const {
  for (const Body& body : bodies_) {
    if (!body.rigid || rigid_body-- > 0) continue;
    const auto wet = std::ranges::count(body.wet, 1);
    return static_cast<double>(wet) / static_cast<double>(std::max<std::size_t>(body.wet.size(), 1));
  }
  return 0;
}

/// A sample is wet by the liquid of any rank.
void Walls::share_wet(Ranks& ranks) {
  for (Body& body : bodies_) {
    if (body.wet.empty()) continue;
    const std::vector<char> all = ranks.gathered(body.wet);
    for (std::size_t k = 0; k < all.size(); ++k)
      if (all[k] != 0) body.wet[k % body.wet.size()] = 1;
  }
}

void Walls::add_to(FluidParticles& particles, WallSums& sums) {
  const std::size_t n = particles.size(), chunks = (n + kChunk - 1) / kChunk;
  sums.first.resize(n + 1);
  for (Body& body : bodies_) body.wet.assign(body.rigid ? body.position.size() : 0, 0);
  found_.resize(chunks);
  parallel_for(
      chunks, [&](std::size_t chunk) { add_to_chunk(chunk, particles, sums); }, 1);
  if (particles.halo != nullptr) share_wet(particles.halo->ranks());

  first_of_chunk_.assign(1, 0);
  for (const Found& found : found_) first_of_chunk_.push_back(first_of_chunk_.back() + found.friction.size());
  const std::size_t contacts = first_of_chunk_.back();
  sums.friction.resize(contacts);
  sums.velocity.resize(moving_ ? contacts : 0);
  sums.heat.resize(heats_ ? contacts : 0);
  sums.body.resize(rigid_ ? contacts : 0);
  sums.gradient.resize(rigid_ ? contacts : 0);
  sums.first[n] = static_cast<std::uint32_t>(contacts);
  parallel_for(
      chunks,
      [&](std::size_t chunk) {
        const auto first = static_cast<std::ptrdiff_t>(first_of_chunk_[chunk]);
        const Found& found = found_[chunk];
        std::ranges::copy(found.friction, sums.friction.begin() + first);
        std::ranges::copy(found.velocity, sums.velocity.begin() + first);
        std::ranges::copy(found.heat, sums.heat.begin() + first);
        std::ranges::copy(found.body, sums.body.begin() + first);
        std::ranges::copy(found.gradient, sums.gradient.begin() + first);
        for (std::size_t i = chunk * kChunk; i < std::min((chunk + 1) * kChunk, n); ++i)
          sums.first[i] += static_cast<std::uint32_t>(first);
      },
      1);
}

}  // namespace kappaflow
