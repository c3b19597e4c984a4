#include "surface/field/surface_feet.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/quantile.h"

namespace kappaflow {
namespace {

constexpr std::size_t kGrain = 64;       // feet of a task
constexpr double kLargestStep = 0.4;     // [sigma] of Newton's method
constexpr double kSmallestSlope = 0.05;  // [1] change of f over one sigma; a surface's is 0.5 and more
constexpr double kConverged = 0.01;      // [sigma] a foot's distance from the level set
constexpr double kLeastAgreement = 0.7;  // [1] cosine between normals that say nothing about each other
constexpr double kFarthest = 1.3;        // [sigma] from its particle: what is further away has no say
constexpr double kCellsPerRadius = 3;    // a box of cells holds a window closely

}  // namespace

void walk_to_surface(const Field& field, std::span<const Vec3> origin, std::span<const double> sigma,
                     int steps, double farthest, std::vector<Foot>& feet) {
  parallel_for(
      feet.size(),
      [&](std::size_t i) {
        Foot& foot = feet[i];
        const double least_slope = kSmallestSlope / sigma[i];
        if (foot.distance == kInfinity) return;
        foot.distance = kInfinity;
        ValueAndGradient at = field.value_and_gradient(foot.position);
        for (int step = 0; step < steps; ++step) {
          const double slope = at.g.norm(), longest = kLargestStep * sigma[i];
          if (!(slope > least_slope)) return;
          foot.position += std::clamp(-at.f / slope, -longest, longest) / slope * at.g;
          if (!((foot.position - origin[i]).norm() < farthest * sigma[i])) return;
          at = field.value_and_gradient(foot.position);
        }
        const double slope = at.g.norm();
        if (!(slope > least_slope) || !(std::abs(at.f) < kConverged * sigma[i] * slope)) return;
        foot.normal = -at.g / slope;
        foot.distance = (foot.position - origin[i]).norm() / sigma[i];
      },
      kGrain);
}

SurfaceFeet::SurfaceFeet(std::span<const Foot> feet, std::span<const double> sigma, double radius)
    : radius_(sigma.begin(), sigma.end()) {
  if (feet.empty()) return;
  for (double& r : radius_) r *= radius;
  std::vector<double> radii = radius_;
  std::vector<Vec3> place;
  std::vector<std::uint32_t> known;
  for (std::uint32_t i = 0; i < feet.size(); ++i)
    if (feet[i].distance < kFarthest) {
      place.push_back(feet[i].position);
      known.push_back(i);
    }
  grid_.build(std::span<const Vec3>(place), upper_median(radii) / kCellsPerRadius);
  const std::size_t n = known.size();
  foot_.resize(n);
  for (auto* arrays : {&y_, &n_})
    for (auto& array : *arrays) array.resize(n);
  weight_.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    foot_[k] = known[grid_.order()[k]];
    for (int a = 0; a < 3; ++a) y_[a][k] = feet[foot_[k]].position[a], n_[a][k] = feet[foot_[k]].normal[a];
    weight_[k] = std::pow(1 - std::pow(feet[foot_[k]].distance / kFarthest, 2), 2);
  }
}

std::vector<Vec3> SurfaceFeet::smooth_normals(std::span<const Foot> feet) const {
  std::vector<Vec3> result(feet.size(), Vec3::Zero());
  parallel_for(
      feet.size(),
      [&](std::size_t i) {
        if (feet[i].distance == kInfinity) return;
        const double inverse_radius2 = 1 / (radius_[i] * radius_[i]);
        const Vec3 &y = feet[i].position, &n = feet[i].normal;
        Vec3 sum = Vec3::Zero();
        grid_.ranges_near(y, radius_[i], [&](std::uint32_t begin, std::uint32_t end) {
          const double *yx = y_[0].data(), *yy = y_[1].data(), *yz = y_[2].data(), *nx = n_[0].data(),
                       *ny = n_[1].data(), *nz = n_[2].data(), *w = weight_.data();
          const double y0 = y[0], y1 = y[1], y2 = y[2], n0 = n[0], n1 = n[1], n2 = n[2];
          double sx = 0, sy = 0, sz = 0;
#pragma omp simd reduction(+ : sx, sy, sz)
          for (std::size_t j = begin; j < end; ++j) {
            const double dx = yx[j] - y0, dy = yy[j] - y1, dz = yz[j] - y2;
            const double near = std::max(0.0, 1 - (dx * dx + dy * dy + dz * dz) * inverse_radius2),
                         agree = std::max(0.0, n0 * nx[j] + n1 * ny[j] + n2 * nz[j] - kLeastAgreement);
            const double a = w[j] * agree * near * near * near;
            sx += a * nx[j], sy += a * ny[j], sz += a * nz[j];
          }
          sum += Vec3(sx, sy, sz);
        });
        result[i] = sum.normalized();
      },
      kGrain);
  return result;
}

std::vector<double> SurfaceFeet::heights(std::span<const Foot> feet, std::span<const Vec3> smooth) const {
  std::vector<double> result(feet.size(), 0.0);
  std::array<std::vector<double>, 3> m;
  for (int a = 0; a < 3; ++a) {
    m[a].resize(foot_.size());
    for (std::size_t k = 0; k < foot_.size(); ++k) m[a][k] = smooth[foot_[k]][a];
  }
  parallel_for(
      feet.size(),
      [&](std::size_t i) {
        if (feet[i].distance == kInfinity) return;
        const double inverse_radius2 = 1 / (radius_[i] * radius_[i]);
        const Vec3 &y = feet[i].position, &n = feet[i].normal, &own = smooth[i];
        double weights = 0, sum = 0;
        grid_.ranges_near(y, radius_[i], [&](std::uint32_t begin, std::uint32_t end) {
          const double *yx = y_[0].data(), *yy = y_[1].data(), *yz = y_[2].data(), *nx = n_[0].data(),
                       *ny = n_[1].data(), *nz = n_[2].data(), *mx = m[0].data(), *my = m[1].data(),
                       *mz = m[2].data(), *w = weight_.data();
          const double y0 = y[0], y1 = y[1], y2 = y[2], n0 = n[0], n1 = n[1], n2 = n[2], m0 = own[0],
                       m1 = own[1], m2 = own[2];
          double run_weights = 0, run_sum = 0;
#pragma omp simd reduction(+ : run_weights, run_sum)
          for (std::size_t j = begin; j < end; ++j) {
            const double dx = yx[j] - y0, dy = yy[j] - y1, dz = yz[j] - y2;
            const double near = std::max(0.0, 1 - (dx * dx + dy * dy + dz * dz) * inverse_radius2),
                         agree = std::max(0.0, n0 * nx[j] + n1 * ny[j] + n2 * nz[j] - kLeastAgreement);
            const double a = w[j] * agree * near * near * near;
            run_weights += a;
            run_sum += a * 0.5 * ((m0 + mx[j]) * dx + (m1 + my[j]) * dy + (m2 + mz[j]) * dz);
          }
          weights += run_weights;
          sum += run_sum;
        });
        result[i] = weights > 0 ? sum / weights : 0;
      },
      kGrain);
  return result;
}

SurfaceFeet::Normals SurfaceFeet::normals_around(const Vec3& x, double radius) const {
  SymmetricMatrix sum{};
  double nearest2 = kInfinity;
  const double inverse_radius2 = 1 / (radius * radius);
  grid_.ranges_near(x, radius, [&](std::uint32_t begin, std::uint32_t end) {
    const double *yx = y_[0].data(), *yy = y_[1].data(), *yz = y_[2].data(), *nx = n_[0].data(),
                 *ny = n_[1].data(), *nz = n_[2].data(), *w = weight_.data();
    const double x0 = x[0], x1 = x[1], x2 = x[2];
    double xx = 0, xy = 0, xz = 0, y_y = 0, y_z = 0, z_z = 0, least = kInfinity;
#pragma omp simd reduction(+ : xx, xy, xz, y_y, y_z, z_z) reduction(min : least)
    for (std::size_t j = begin; j < end; ++j) {
      const double dx = yx[j] - x0, dy = yy[j] - x1, dz = yz[j] - x2, r2 = dx * dx + dy * dy + dz * dz;
      const double near = std::max(0.0, 1 - r2 * inverse_radius2), a = w[j] * near * near * near;
      least = std::min(least, r2);
      xx += a * nx[j] * nx[j], xy += a * nx[j] * ny[j], xz += a * nx[j] * nz[j];
      y_y += a * ny[j] * ny[j], y_z += a * ny[j] * nz[j], z_z += a * nz[j] * nz[j];
    }
    const SymmetricMatrix run{xx, xy, xz, y_y, y_z, z_z};
    for (int ab = 0; ab < 6; ++ab) sum[ab] += run[ab];
    nearest2 = std::min(nearest2, least);
  });
  Normals result{.tensor = full(sum), .nearest = std::sqrt(nearest2)};
  const Vec3 eigenvalues = Eigen::SelfAdjointEigenSolver<Mat3>()
                               .computeDirect(result.tensor, Eigen::EigenvaluesOnly)
                               .eigenvalues();
  if (!(eigenvalues[2] > 0)) return result;
  result.tensor /= eigenvalues[2];
  result.second = eigenvalues[1] / eigenvalues[2];
  return result;
}

}  // namespace kappaflow
