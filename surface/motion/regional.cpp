#include "surface/motion/regional.h"

#include <tbb/enumerable_thread_specific.h>

#include "surface/mesh/surface_samples.h"
#include "surface/motion/affine_fit.h"
#include "surface/motion/normal.h"
#include "surface/motion/pointwise.h"

namespace kappaflow {
namespace {

// In units of the length scale at the point.
constexpr double kRadius = 1.25, kLargestRadius = 2.5, kSampleSpacing = 0.25;
constexpr double kGrowth = 1.42;      // of the radius from one attempt to the next
constexpr double kDetermined = 0.05;  // AffineFit::determined that a window is content with
constexpr std::size_t kPointsPerTask = 64;

/// What is known at every point before any window is looked at.
struct LocalMotion {
  std::vector<Vec3> normal;           // unit; zero where the field has no gradient
  std::vector<Vec3> normal_velocity;  // Eq. 4 [m/s]
  std::vector<double> length_scale;   // [m]; 0 where the field has no gradient
  std::vector<PointEquations> equations;
};

LocalMotion local_motion(const Field& field, std::span<const Vec3> position, const VelocityOptions& options) {
  const std::size_t n = position.size();
  LocalMotion local{.normal = std::vector<Vec3>(n, Vec3::Zero()),
                    .normal_velocity = std::vector<Vec3>(n, Vec3::Zero()),
                    .length_scale = std::vector<double>(n, 0.0),
                    .equations = std::vector<PointEquations>(n)};
  parallel_for(
      n,
      [&](std::size_t v) {
        StrainResponse strain;
        const Jet jet = field.jet(position[v], strain);
        if (!has_gradient(jet)) return;
        local.normal[v] = jet.g.normalized();
        local.normal_velocity[v] = normal_velocity(jet, options);
        local.length_scale[v] = jet.length_scale;
        local.equations[v] = point_equations(jet, strain, local.normal_velocity[v]);
      },
      kPointsPerTask);
  return local;
}

/// Fits windows around points; one a thread.
class WindowFit {
 public:
  AffineFit operator()(const LocalMotion& local, const SurfaceSamples& samples, const Vec3& x, int v) {
    const double scale = local.length_scale[v];
    for (double radius = kRadius * scale;; radius *= kGrowth) {
      const AffineFit fit = fit_within(local, samples, x, v, radius);
      if (fit.determined >= kDetermined || radius * kGrowth > kLargestRadius * scale) return fit;
    }
  }

 private:
  AffineFit fit_within(const LocalMotion& local, const SurfaceSamples& samples, const Vec3& x, int v,
                       double radius) {
    WindowSums sums(x, radius);
    for (const int s : walk_.around(samples, x, samples.of_vertex[v], radius)) {
      const Vec3& y = samples.position[s];
      const double u = std::max(0.0, 1 - (y - x).squaredNorm() / (radius * radius));
      sums.add(local.equations[samples.vertex[s]], y, samples.patch_area[s] * u * u);
    }
    if (!(sums.weight() > 0)) sums.add(local.equations[v], x, 1);
    return sums.solve(local.normal[v]);
  }

  SampleWalk walk_;
};

}  // namespace

void evaluate_regional(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                       SurfaceVelocities& result) {
  const std::size_t n = points.position.size();
  const LocalMotion local = local_motion(field, points.position, options);
  std::vector<double> spacing(n);
  std::ranges::transform(local.length_scale, spacing.begin(), [](double L) { return kSampleSpacing * L; });
  const SurfaceSamples samples = surface_samples(points.position, points.area, points.rings, spacing);
  result.velocity.assign(n, Vec3::Zero());
  result.confidence.assign(n, 0.0);
  tbb::enumerable_thread_specific<WindowFit> window_fit;
  parallel_for(
      n,
      [&](std::size_t v) {
        if (!(local.length_scale[v] > 0)) return;
        const AffineFit fit = window_fit.local()(local, samples, points.position[v], static_cast<int>(v));
        const Vec3 tangential = fit.velocity - fit.velocity.dot(local.normal[v]) * local.normal[v];
        result.velocity[v] =
            local.normal_velocity[v] + limited(tangential, options.speed_limit * field.fastest_speed());
        result.confidence[v] = confidence(fit.determined, options.damping);
      },
      kPointsPerTask);
}

}  // namespace kappaflow
