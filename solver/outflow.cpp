#include "solver/outflow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "core/parallel.h"
#include "solver/fluid_particles.h"
#include "solver/halo.h"

namespace kappaflow {
namespace {

void require_outflow(bool holds, const std::string& message) {
  if (!holds) throw InvalidInput("outflow: " + message);
}

void require_radius(double radius) {
  require_outflow(std::isfinite(radius) && radius > 0, fmt::format("radius = {} m; must be above 0", radius));
}

void check_shape(const BoxShape& box) {
  require_outflow(
      box.lower.allFinite() && box.upper.allFinite() && (box.lower.array() < box.upper.array()).all(),
      "its upper corner must be above the lower one in every component");
}
void check_shape(const SphereShape& sphere) {
  require_outflow(sphere.center.allFinite(), "its centre must be finite");
  require_radius(sphere.radius);
}
void check_shape(const CylinderShape& cylinder) {
  require_outflow(cylinder.from.allFinite() && cylinder.to.allFinite() && cylinder.from != cylinder.to,
                  "its ends must be finite and apart");
  require_radius(cylinder.radius);
}

bool contains(const BoxShape& box, const Vec3& x) {
  return (box.lower.array() <= x.array()).all() && (x.array() <= box.upper.array()).all();
}
bool contains(const SphereShape& sphere, const Vec3& x) {
  return (x - sphere.center).squaredNorm() <= sphere.radius * sphere.radius;
}
bool contains(const CylinderShape& cylinder, const Vec3& x) {
  const Vec3 axis = cylinder.to - cylinder.from, from = x - cylinder.from;
  const double along = from.dot(axis) / axis.squaredNorm();
  return along >= 0 && along <= 1 && (from - along * axis).squaredNorm() <= cylinder.radius * cylinder.radius;
}

}  // namespace

void check_outflow(const Outflow& outflow) {
  std::visit([](const auto& shape) { check_shape(shape); }, outflow.shape);
}

bool is_in(const Outflow& outflow, const Vec3& x) {
  return std::visit([&](const auto& shape) { return contains(shape, x); }, outflow.shape);
}

void Outflows::take(FluidParticles& particles) {
  if (regions_.empty()) return;
  region_of_.resize(particles.size());
  parallel_for(particles.size(), [&](std::size_t i) {
    const Vec3 x = particles.position[i].head<3>().cast<double>();
    const auto found =
        std::ranges::find_if(regions_, [&](const Outflow& region) { return is_in(region, x); });
    region_of_[i] = static_cast<std::uint8_t>(found - regions_.begin());
  });
  kept_.clear();
  std::vector<std::size_t> now(regions_.size(), 0);
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (region_of_[i] == regions_.size())
      kept_.push_back(static_cast<std::uint32_t>(i));
    else
      ++now[region_of_[i]];
  sum_each_of_ranks(particles, now);
  for (std::size_t region = 0; region < now.size(); ++region) taken_[region] += now[region];
  if (kept_.size() < particles.size()) particles.keep(kept_);
}

}  // namespace kappaflow
