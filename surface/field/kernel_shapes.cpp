#include "surface/field/kernel_shapes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "surface/field/anisotropic_field.h"
#include "surface/field/stray_particles.h"
#include "surface/field/surface_feet.h"

namespace kappaflow {
namespace {

// The shapes, see the header.
constexpr double kStretch = 1.3;                  // [sigma] along a surface
constexpr double kAcross = 0.5;                   // of the square of that, across it
constexpr double kThin = 0.1, kHalfSpace = 0.33;  // [1] of variances: a half-space has a third across
constexpr double kVarianceRadius = 1.5;           // [sigma]
constexpr double kKernelVariance = 1.0 / 11;      // of (1 - r^2)^3 in the unit ball, along an axis
constexpr double kFrameFromVariances = 0.2;       // [1] beside normals, for the axes of what has no normal
// The surface that is smoothed.
constexpr double kFirstLevel = 0.4;  // of T: a level set that sheets and threads of one particle have too
constexpr double kDepth = 1.6;       // [sigma] that a particle is away from it at most
constexpr double kRadius = 3.6;      // [sigma] of the windows
constexpr double kNormalsRadius = 2;
constexpr double kRelaxation = 2;      // [1] kernels pass on about half of how their centres move
constexpr double kLargestMove = 0.16;  // [sigma] in one pass
constexpr int kFirstSteps = 4, kSecondSteps = 3;
constexpr double kLargestWeight = 10;  // of a kernel beside that of its particle

/// The particles that count, with arrays in the order of a grid whose cells are as large as windows.
class Variances {
 public:
  Variances(std::span<const Vec3> position, double largest_sigma)
      : largest_radius_(kVarianceRadius * largest_sigma) {
    grid_.build(position, 0.5 * largest_radius_);
    for (int a = 0; a < 3; ++a) {
      x_[a].resize(position.size());
      for (std::size_t k = 0; k < position.size(); ++k) x_[a][k] = position[grid_.order()[k]][a];
    }
  }

  /// Covariances of the positions around x over those in the inside of a body.
  Mat3 around(const Vec3& x, double sigma) const {
    const double radius = kVarianceRadius * sigma, inverse_radius2 = 1 / (radius * radius);
    double weight = 0;
    Vec3 first = Vec3::Zero();
    SymmetricMatrix second{};
    grid_.ranges_near(x, radius, [&](std::uint32_t begin, std::uint32_t end) {
      const double *px = x_[0].data(), *py = x_[1].data(), *pz = x_[2].data();
      const double x0 = x[0], x1 = x[1], x2 = x[2];
      double s = 0, sx = 0, sy = 0, sz = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
#pragma omp simd reduction(+ : s, sx, sy, sz, xx, xy, xz, yy, yz, zz)
      for (std::size_t j = begin; j < end; ++j) {
        const double dx = px[j] - x0, dy = py[j] - x1, dz = pz[j] - x2;
        const double u = std::max(0.0, 1 - (dx * dx + dy * dy + dz * dz) * inverse_radius2), a = u * u * u;
        s += a;
        sx += a * dx, sy += a * dy, sz += a * dz;
        xx += a * dx * dx, xy += a * dx * dy, xz += a * dx * dz;
        yy += a * dy * dy, yz += a * dy * dz, zz += a * dz * dz;
      }
      weight += s;
      first += Vec3(sx, sy, sz);
      const SymmetricMatrix run{xx, xy, xz, yy, yz, zz};
      for (int ab = 0; ab < 6; ++ab) second[ab] += run[ab];
    });
    const Vec3 mean = first / weight;
    return (full(second) / weight - mean * mean.transpose()) * (inverse_radius2 / kKernelVariance);
  }

 private:
  double largest_radius_;
  CellGrid grid_;
  std::array<std::vector<double>, 3> x_;
};

/// S of the header. at_surface: 0 in the depth, 1 from half-way up to the surface. C: of Variances.
Mat3 squared_radii(double at_surface, const SurfaceFeet::Normals& normals, const Mat3& C) {
  constexpr double along = kStretch * kStretch;
  const Mat3 Q = at_surface * normals.tensor;
  const Mat3 axes =
      Eigen::SelfAdjointEigenSolver<Mat3>().computeDirect(Q - kFrameFromVariances * C).eigenvectors();
  Vec3 s;
  for (int a = 0; a < 3; ++a) {
    const Vec3 axis = axes.col(a);
    const double q = axis.dot(Q * axis), c = std::max(0.0, axis.dot(C * axis));
    s[a] =
        (1 + (along - 1) * at_surface - (1 - kAcross) * along * q) * std::min(1.0, (c + kThin) / kHalfSpace);
  }
  return axes * s.asDiagonal() * axes.transpose();
}

/// field: whose surface the feet are on. A particle that has none around it, and is not in the depth of a
/// body, is in the middle of an even sheet or thread: Newton's method does not know which way to go there.
void set_shapes(const FieldParticles& p, const Field& field, double threshold, const SurfaceFeet& feet,
                KernelShapes& shapes) {
  constexpr double kSheet =
      0.8;  // [T] a sheet of single particles has 0.6 more than the first level, a body 1.6
  const Variances variances(p.position, *std::ranges::max_element(p.sigma));
  parallel_for(p.position.size(), [&](std::size_t i) {
    const double sigma = p.sigma[i];
    const Vec3& x = p.position[i];
    const SurfaceFeet::Normals normals = feet.normals_around(x, kNormalsRadius * sigma);
    const double near = normals.nearest / (kDepth * sigma), at_surface = std::min(1.0, 2 * (1 - near * near));
    const auto is_in_sheet = [&] {
      const double f = field.value_and_gradient(x).f;
      return f > 0 && f < kSheet * threshold;
    };
    const Mat3 S = at_surface > 0 || is_in_sheet()
                       ? squared_radii(std::max(0.0, at_surface), normals, variances.around(x, sigma))
                       : Mat3::Identity();
    shapes.shape[i] = symmetric(S.inverse() / (sigma * sigma));
    shapes.weight[i] = p.weight[i] / std::sqrt(S.determinant());
  });
}

/// Moves centres along the smoothed normals of their feet.
void smooth_centers(const FieldParticles& p, const SurfaceFeet& surface, std::span<const Foot> feet,
                    std::span<const Vec3> normals, KernelShapes& shapes) {
  const std::vector<double> heights = surface.heights(feet, normals);
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const double height = kRelaxation * heights[i], most = kLargestMove * p.sigma[i];
    shapes.offset[i] += height / std::sqrt(1 + height * height / (most * most)) * normals[i];
  }
}

AnisotropicField field_of(const FieldParticles& p, const KernelShapes& shapes, double threshold) {
  FieldKernels kernels{.center = p.position,
                       .velocity = std::vector<Vec3>(p.position.size(), Vec3::Zero()),
                       .shape = shapes.shape,
                       .shape_rate = std::vector<SymmetricMatrix>(p.position.size(), SymmetricMatrix{}),
                       .weight = shapes.weight,
                       .weight_rate = std::vector<double>(p.position.size(), 0.0)};
  for (std::size_t i = 0; i < p.position.size(); ++i) kernels.center[i] += shapes.offset[i];
  return {p, kernels, threshold, 0};
}

/// Of particles that are near others.
KernelShapes shapes_of(const FieldParticles& p, double threshold) {
  const std::size_t n = p.position.size();
  KernelShapes shapes{.offset = std::vector<Vec3>(n, Vec3::Zero()),
                      .shape = std::vector<SymmetricMatrix>(n),
                      .weight = std::vector<double>(n)};
  if (n == 0) return shapes;
  const double radius = kRadius * *std::ranges::max_element(p.sigma);
  std::vector<Foot> feet(n);
  for (std::size_t i = 0; i < n; ++i) feet[i] = {.position = p.position[i], .distance = 0};
  const ParticleField first(p, kFirstLevel * threshold, 0);
  walk_to_surface(first, p.position, p.sigma, kFirstSteps, kDepth, feet);
  const SurfaceFeet surface(feet, radius);
  const std::vector<Vec3> normals = surface.smooth_normals(feet);
  set_shapes(p, first, threshold, surface, shapes);
  smooth_centers(p, surface, feet, normals, shapes);
  walk_to_surface(field_of(p, shapes, threshold), p.position, p.sigma, kSecondSteps, kDepth, feet);
  smooth_centers(p, SurfaceFeet(feet, radius), feet, normals, shapes);
  return shapes;
}

}  // namespace

KernelShapes kernel_shapes(const FieldParticles& p, double threshold) {
  const std::vector<std::uint32_t> kept =
      without_strays(p.position, p.sigma, p.weight, threshold / kLargestWeight);
  if (kept.size() == p.position.size()) return shapes_of(p, threshold);
  FieldParticles near;
  for (const std::uint32_t i : kept) {
    near.position.push_back(p.position[i]);
    near.velocity.push_back(p.velocity[i]);
    near.sigma.push_back(p.sigma[i]);
    near.weight.push_back(p.weight[i]);
    near.weight_rate.push_back(p.weight_rate[i]);
  }
  const KernelShapes of_near = shapes_of(near, threshold);
  KernelShapes shapes{.offset = std::vector<Vec3>(p.position.size(), Vec3::Zero()),
                      .shape = std::vector<SymmetricMatrix>(p.position.size()),
                      .weight = p.weight};
  for (std::size_t i = 0; i < p.position.size(); ++i)
    shapes.shape[i] = symmetric(Mat3::Identity() / (p.sigma[i] * p.sigma[i]));
  for (std::size_t k = 0; k < kept.size(); ++k) {
    shapes.offset[kept[k]] = of_near.offset[k];
    shapes.shape[kept[k]] = of_near.shape[k];
    shapes.weight[kept[k]] = of_near.weight[k];
  }
  return shapes;
}

}  // namespace kappaflow
