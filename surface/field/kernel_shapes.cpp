#include "surface/field/kernel_shapes.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/errors.h"
#include "core/parallel.h"
#include "core/quantile.h"
#include "surface/field/anisotropic_field.h"
#include "surface/field/stray_particles.h"
#include "surface/field/surface_feet.h"

namespace kappaflow {
namespace {

// The shapes, see the header.
constexpr double kStretch = 1.5;  // [sigma] along a surface
constexpr double kBend = 2;       // [1] shorter where the surface is bent: of the normals' second eigenvalue
constexpr double kAcross = 0.5;   // of the square of that, across it
constexpr double kVarianceRadius = 1.5;       // [sigma]
constexpr double kKernelVariance = 1.0 / 11;  // of (1 - r^2)^3 in the unit ball, along an axis
// [sigma^2] of positions in the inside of a body, within kVarianceRadius
constexpr double kInsideVariance = kKernelVariance * kVarianceRadius * kVarianceRadius;
constexpr double kFrameFromVariances = 0.2;  // [1] beside normals, for the axes of what has no normal
// Sheets and threads.
constexpr double kThin = 0.08, kNotThin = 0.3;   // [1] of variances: a half-space has a third across
constexpr double kSheetThickness = 256.0 / 315;  // [sigma] with round kernels that add up to the inside's sum
constexpr double kThreadSection = 2.0 / 9;       // [sigma^2] square of a thread's radius likewise
constexpr double kThickest = 0.7;                // [sigma] more cannot be told from a body
constexpr double kThinnestSheet = 0.4, kThinnestThread = 0.25;  // [sigma] that kernels are made for
constexpr double kSheetWidth = 1.25, kThreadWidth = 1.1;        // kernels' radius over thickness and diameter
constexpr double kSheetPeak = 0.96;       // [1] of what an even sheet has: others lie beside its middle
constexpr double kLeastSheetPeak = 1.6;   // [T] less makes holes between the particles
constexpr double kThreadPeak = 2.25;      // [T]
constexpr double kNarrowest = 0.23;       // of the square of kernels' radius
constexpr double kLargestCorrection = 2;  // of weights
constexpr double kFilled = 0.85;          // of the inside's sum: more is no sheet
// The surface that is smoothed.
constexpr double kFirstLevel = 0.4;  // of T: a level set that sheets and threads of one particle have too
constexpr double kDepth = 1.6;       // [sigma] that a particle is away from it at most
constexpr double kRadius = 3.6;      // [sigma] of the windows
constexpr double kNormalsRadius = 2;
constexpr double kRelaxation = 2;     // [1] kernels pass on about half of how their centres move
constexpr double kLargestMove = 0.2;  // [sigma] in all
constexpr int kPasses = 3, kFirstSteps = 4, kLaterSteps = 3;
constexpr double kLargestWeight = 10;  // of a kernel beside that of its particle

/// The particles' positions, in the order of a grid.
class Variances {
 public:
  Variances(std::span<const Vec3> position, double sigma) {
    grid_.build(position, 0.5 * kVarianceRadius * sigma);
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
  CellGrid grid_;
  std::array<std::vector<double>, 3> x_;
};

/// Whether what is around a particle is a sheet, a thread or a drop: shares, all 0 in and on a body.
struct Thinness {
  double sheet = 0, thread = 0, drop = 0;
};

/// variance: of Variances, ascending.
Thinness thinness_of(const Vec3& variance) {
  const Vec3 thin = ((kNotThin - variance.array()) / (kNotThin - kThin)).max(0.0).min(1.0);
  return {.sheet = thin[0] * (1 - thin[1]), .thread = thin[1] * (1 - thin[2]), .drop = thin[2]};
}

/// The eigenvalue of S across a sheet or thread with kernels of this radius [sigma], less what the particles'
/// own places spread them.
double squared_radius(double radius, double variance) {
  const double square = radius * radius;
  return std::max(square - variance * kInsideVariance / kKernelVariance, kNarrowest * square);
}

/// What kernels of a sheet or thread should add up to in its middle.
struct Middle {
  double share = 0;  ///< 0: neither a sheet nor a thread
  double peak = 0;   ///< [T] puts the surface in its place
};

struct KernelSize {
  Mat3 squared_radii = Mat3::Identity();  ///< S of the header
  Middle middle;
};

/// at_surface: 0 in the depth, 1 from half-way up to the surface. C: of Variances. filled: the sum of the
/// round kernels at the particle over that of the inside.
KernelSize kernel_size(double at_surface, const SurfaceFeet::Normals& normals, const Mat3& C, double filled) {
  const Mat3 Q = at_surface * normals.tensor;
  const double bend = std::min(1.0, kBend * normals.second),
               along = 1 + (kStretch * kStretch - 1) * (1 - bend), across = kAcross * along;
  Mat3 axes = Eigen::SelfAdjointEigenSolver<Mat3>().computeDirect(Q - kFrameFromVariances * C).eigenvectors();
  const auto along_axis = [&](const Mat3& tensor, int a) { return axes.col(a).dot(tensor * axes.col(a)); };
  std::array<std::pair<double, int>, 3> order;
  for (int a = 0; a < 3; ++a) order[a] = {std::max(0.0, along_axis(C, a)), a};
  std::ranges::sort(order);
  axes = Mat3(axes(Eigen::all, std::array{order[0].second, order[1].second, order[2].second}));
  const Vec3 variance(order[0].first, order[1].first, order[2].first);
  Vec3 s;
  for (int a = 0; a < 3; ++a) s[a] = 1 + (along - 1) * at_surface - (along - across) * along_axis(Q, a);
  const Thinness thinness = thinness_of(variance);
  // Particles that are spread across do not all count fully in the sum: their kernels fall as 1 - 4 d^2.
  const double all = filled / (1 - 8 * kInsideVariance * std::min(variance[0], kNotThin)),
               thickness = std::min(kSheetThickness * all, kThickest),
               sheet_radius = kSheetWidth * std::max(thickness, kThinnestSheet),
               diameter = std::clamp(2 * std::sqrt(kThreadSection * all), kThinnestThread, kThickest);
  const auto blend = [&](int a, double share, double to) { s[a] += share * (std::min(to, across) - s[a]); };
  blend(0, thinness.sheet, squared_radius(sheet_radius, variance[0]));
  for (const int a : {0, 1}) blend(a, thinness.thread, squared_radius(kThreadWidth * diameter, variance[a]));
  s += thinness.drop * (Vec3::Ones() - s);
  // From its middle on, the sum of a sheet's kernels falls as (1 - u^2)^4 with the distance u in their radii.
  const double u = 0.5 * thickness / sheet_radius,
               sheet_peak = std::max(kLeastSheetPeak, kSheetPeak * std::pow(1 - u * u, -4)),
               share = thinness.sheet + thinness.thread,
               peak = thinness.sheet * sheet_peak + thinness.thread * kThreadPeak;
  const Middle middle{share, share > 0 ? peak / share : 0};
  return {axes * s.asDiagonal() * axes.transpose(), middle};
}

/// field: whose surface the feet are on. A particle that has none around it, and is not in the depth of a
/// body, is in the middle of an even sheet or thread: Newton's method does not know which way to go there.
std::vector<Middle> set_shapes(const FieldParticles& p, const Field& field, double threshold,
                               const SurfaceFeet& feet, KernelShapes& shapes) {
  std::vector<double> sigmas = p.sigma, weights = p.weight;
  const Variances variances(p.position, quantile(sigmas, 0.5));
  // Weights that are normalised are smallest inside.
  const double inside_weight = quantile(weights, 0.1), inside = 2 * threshold / inside_weight;
  std::vector<Middle> middle(p.position.size());
  // Of particles with such a weight the sum of the round kernels at x over that of the inside.
  const auto filled_at = [&](const Vec3& x, double weight) {
    const double sum = (field.value_and_gradient(x).f + kFirstLevel * threshold) / weight;
    return weight > 0 && inside_weight > 0 ? sum / inside : 1;
  };
  parallel_for(p.position.size(), [&](std::size_t i) {
    const double sigma = p.sigma[i];
    const Vec3& x = p.position[i];
    const SurfaceFeet::Normals normals = feet.normals_around(x, kNormalsRadius * sigma);
    const double near = normals.nearest / (kDepth * sigma), at_surface = std::min(1.0, 2 * (1 - near * near)),
                 filled = filled_at(x, p.weight[i]);
    KernelSize size;
    if (at_surface > 0 || filled < kFilled)
      size = kernel_size(std::max(0.0, at_surface), normals, variances.around(x, sigma), filled);
    shapes.shape[i] = symmetric(size.squared_radii.inverse() / (sigma * sigma));
    // Weights that are normalised for round kernels would make what is thin too thick.
    const double weight = p.weight[i] + size.middle.share * (inside_weight - p.weight[i]);
    shapes.weight[i] = weight / std::sqrt(size.squared_radii.determinant());
    middle[i] = size.middle;
  });
  return middle;
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

/// Weights of sheets and threads, by what their kernels add up to in the middle: there sums over few
/// particles are uneven, and kernels that are flat miss each other where the sheet is bent.
void correct_weights(const FieldParticles& p, std::span<const Middle> middle, double threshold,
                     KernelShapes& shapes) {
  if (std::ranges::none_of(middle, [](const Middle& of) { return of.share > 0; })) return;
  const AnisotropicField field = field_of(p, shapes, threshold);
  parallel_for(p.position.size(), [&](std::size_t i) {
    const Middle& of = middle[i];
    if (!(of.share > 0)) return;
    const ValueAndGradient at = field.value_and_gradient(p.position[i]);
    // The sum falls as peak (1 - u^2)^4 with the distance u from the middle, in radii: its slope tells u.
    const double sum = at.f + threshold, slope = std::sqrt(at.g.dot(full(shapes.shape[i]).inverse() * at.g)),
                 b = slope / (8 * sum), u = std::min(2 * b / (1 + std::sqrt(1 + 4 * b * b)), 1 / kSheetWidth),
                 peak = sum / std::pow(1 - u * u, 4),
                 times = std::clamp(of.peak * threshold / peak, 1 / kLargestCorrection, kLargestCorrection);
    shapes.weight[i] *= 1 + of.share * of.share * (times - 1);
  });
}

/// Moves centres along the smoothed normals of their feet. height: how far those want to be moved in all [m].
void smooth_centers(const FieldParticles& p, const SurfaceFeet& surface, std::span<const Foot> feet,
                    std::span<const Vec3> normals, std::span<double> height, KernelShapes& shapes) {
  const std::vector<double> missing = surface.heights(feet, normals);
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const double distance = std::min(1.0, feet[i].distance / kDepth), at_surface = 1 - std::pow(distance, 4),
                 most = kLargestMove * p.sigma[i];
    height[i] += kRelaxation * at_surface * missing[i];
    shapes.offset[i] = height[i] / std::sqrt(1 + height[i] * height[i] / (most * most)) * normals[i];
  }
}

/// Of particles that are near others.
KernelShapes shapes_of(const FieldParticles& p, double threshold) {
  const std::size_t n = p.position.size();
  KernelShapes shapes{.offset = std::vector<Vec3>(n, Vec3::Zero()),
                      .shape = std::vector<SymmetricMatrix>(n),
                      .weight = std::vector<double>(n)};
  if (n == 0) return shapes;
  std::vector<Foot> feet(n);
  for (std::size_t i = 0; i < n; ++i) feet[i] = {.position = p.position[i], .distance = 0};
  const ParticleField first(p, kFirstLevel * threshold, 0);
  walk_to_surface(first, p.position, p.sigma, kFirstSteps, kDepth, feet);
  const SurfaceFeet surface(feet, p.sigma, kRadius);
  const std::vector<Vec3> normals = surface.smooth_normals(feet);
  correct_weights(p, set_shapes(p, first, threshold, surface, shapes), threshold, shapes);
  std::vector<double> height(n, 0.0);
  smooth_centers(p, surface, feet, normals, height, shapes);
  for (int pass = 1; pass < kPasses; ++pass) {
    walk_to_surface(field_of(p, shapes, threshold), p.position, p.sigma, kLaterSteps, kDepth, feet);
    smooth_centers(p, SurfaceFeet(feet, p.sigma, kRadius), feet, normals, height, shapes);
  }
  return shapes;
}

}  // namespace

KernelShapes kernel_shapes(const FieldParticles& p, double threshold) {
  check_field_particles(p);
  if (!(threshold > 0))
    throw InvalidInput(
        fmt::format("anisotropic kernels: the threshold is {}; it must be above 0", threshold));
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
