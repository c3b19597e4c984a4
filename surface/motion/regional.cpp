#include "surface/motion/regional.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "surface/mesh/surface_samples.h"
#include "surface/motion/affine_fit.h"
#include "surface/motion/normal.h"
#include "surface/motion/pointwise.h"

namespace kappaflow {
namespace {

// In units of the length scale at the point.
constexpr double kRadius = 1.25, kLargestRadius = 2.5, kSampleSpacing = 0.5;
constexpr double kRadiusGrowth = 1.414;  // of the radius from one attempt to the next
constexpr double kDetermined = 0.05;     // AffineFit::determined that a window is content with
constexpr std::size_t kPointsPerTask = 64;

/// What is known at every point before any window is looked at.
struct LocalMotion {
  std::vector<Vec3> normal;           // unit; zero where the field has no gradient
  std::vector<Vec3> normal_velocity;  // Eq. 4 [m/s]
  std::vector<double> length_scale;   // [m]; 0 where the field has no gradient
  std::vector<double> fastest;        // speed in reach [m/s]
  std::vector<MotionEquations> equations;
};

LocalMotion local_motion(const Field& field, std::span<const Vec3> position, const VelocityOptions& options) {
  const std::size_t n = position.size();
  LocalMotion local{.normal = std::vector<Vec3>(n, Vec3::Zero()),
                    .normal_velocity = std::vector<Vec3>(n, Vec3::Zero()),
                    .length_scale = std::vector<double>(n, 0.0),
                    .fastest = std::vector<double>(n, 0.0),
                    .equations = std::vector<MotionEquations>(n)};
  parallel_for(
      n,
      [&](std::size_t v) {
        StrainResponse strain;
        const Jet jet = field.jet(position[v], strain);
        if (!has_gradient(jet)) return;
        local.normal[v] = jet.g.normalized();
        local.normal_velocity[v] = normal_velocity(jet, options);
        local.length_scale[v] = jet.length_scale;
        local.fastest[v] = jet.fastest_in_reach;
        local.equations[v] = motion_equations(jet, strain, local.normal_velocity[v]);
      },
      kPointsPerTask);
  return local;
}

/// The equations of each sample's patch about the sample, weighted by area.
std::vector<MotionEquations> patch_equations(const LocalMotion& local, const SurfacePoints& points,
                                             const SurfaceSamples& samples) {
  std::vector<MotionEquations> patches(samples.vertex.size());
  parallel_for(
      patches.size(),
      [&](std::size_t s) {
        WindowSums sums(samples.position[s]);
        for (const int v : samples.patch(s)) sums.add(local.equations[v], points.position[v], points.area[v]);
        patches[s] = sums.equations();
      },
      kPointsPerTask);
  return patches;
}

/// The fastest speed in reach of each sample's patch.
std::vector<double> patch_fastest(const LocalMotion& local, const SurfaceSamples& samples) {
  std::vector<double> fastest(samples.vertex.size(), 0.0);
  for (std::size_t s = 0; s < fastest.size(); ++s)
    for (const int v : samples.patch(s)) fastest[s] = std::max(fastest[s], local.fastest[v]);
  return fastest;
}

/// What a window tells.
struct Window {
  AffineFit fit;
  double fastest = 0;  // speed in reach of it [m/s]
};

/// Fits windows around points; one a thread.
class WindowFit {
 public:
  Window operator()(const LocalMotion& local, const SurfaceSamples& samples,
                    std::span<const MotionEquations> patches, std::span<const double> fastest_of_patch,
                    const Vec3& x, int v) {
    const double scale = local.length_scale[v];
    for (double radius = kRadius * scale;; radius *= kRadiusGrowth) {
      WindowSums sums(x);
      double fastest = local.fastest[v];
      for (const int s : walk_.around(samples, x, samples.of_vertex[v], radius)) {
        const Vec3& y = samples.position[s];
        const double u = std::max(0.0, 1 - (y - x).squaredNorm() / (radius * radius));
        sums.add(patches[s], y, u * u);
        fastest = std::max(fastest, fastest_of_patch[s]);
      }
      if (!(sums.weight() > 0)) sums.add(local.equations[v], x, 1);
      AffineFit fit = sums.solve(radius, local.normal[v]);
      if (fit.determined >= kDetermined || radius * kRadiusGrowth > kLargestRadius * scale)
        return {fit, fastest};
    }
  }

 private:
  SampleWalk walk_;
};

}  // namespace

void evaluate_regional(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                       SurfaceVelocities& result) {
  const std::size_t n = points.position.size();
  const LocalMotion local = local_motion(field, points.position, options);
  std::vector<double> spacing(n);
  std::ranges::transform(local.length_scale, spacing.begin(), [](double L) { return kSampleSpacing * L; });
  const SurfaceSamples samples = surface_samples(points.position, points.rings, spacing);
  const std::vector<MotionEquations> patches = patch_equations(local, points, samples);
  const std::vector<double> fastest_of_patch = patch_fastest(local, samples);
  result.velocity.assign(n, Vec3::Zero());
  result.confidence.assign(n, 0.0);
  tbb::enumerable_thread_specific<WindowFit> window_fit;
  parallel_for(
      n,
      [&](std::size_t v) {
        if (!(local.length_scale[v] > 0)) return;
        const auto [fit, fastest] = window_fit.local()(local, samples, patches, fastest_of_patch,
                                                       points.position[v], static_cast<int>(v));
        const Vec3 tangential = fit.velocity - fit.velocity.dot(local.normal[v]) * local.normal[v];
        result.velocity[v] = local.normal_velocity[v] + limited(tangential, options.speed_limit * fastest);
        result.confidence[v] = confidence(fit.determined, options.damping);
      },
      kPointsPerTask);
}

}  // namespace kappaflow
