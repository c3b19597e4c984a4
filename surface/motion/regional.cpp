#include "surface/motion/regional.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "surface/mesh/surface_samples.h"
#include "surface/motion/affine_fit.h"
#include "surface/motion/normal.h"
#include "surface/motion/pointwise.h"
#include "surface/motion/tangential_rows.h"

namespace kappaflow {
namespace {

// Of a window, in length scales at the point: what is not affine within it is averaged, see docs/regional.md.
constexpr double kRadius = 1.25, kLargestRadius = 2.5;
constexpr double kSampleSpacing = 0.5;   // [length scales] ten to twenty patches a window
constexpr double kRadiusGrowth = 1.414;  // [1] from one attempt to the next: twice the area
constexpr double kDetermined = 0.05;     // [1] AffineFit::determined that a window is content with
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

/// The surface in patches, each about a sample.
struct Patches {
  SurfaceSamples samples;
  std::vector<MotionEquations> equations;  // of a patch's points about its sample, weighted by area
  std::vector<double> fastest;             // the speed in reach of a patch [m/s]
};

MotionEquations patch_equations(const LocalMotion& local, const SurfacePoints& points, const Vec3& sample,
                                std::span<const int> patch) {
  WindowSums sums(sample);
  for (const int v : patch) sums.add(local.equations[v], points.position[v], points.area[v]);
  return sums.equations();
}

Patches patches_of(const LocalMotion& local, const SurfacePoints& points) {
  std::vector<double> spacing(local.length_scale.size());
  std::ranges::transform(local.length_scale, spacing.begin(), [](double L) { return kSampleSpacing * L; });
  Patches patches{surface_samples(points.position, points.rings, spacing), {}, {}};
  const SurfaceSamples& samples = patches.samples;
  patches.equations.resize(samples.vertex.size());
  parallel_for(
      patches.equations.size(),
      [&](std::size_t s) {
        patches.equations[s] = patch_equations(local, points, samples.position[s], samples.patch(s));
      },
      kPointsPerTask);
  patches.fastest.assign(samples.vertex.size(), 0.0);
  for (std::size_t s = 0; s < patches.fastest.size(); ++s)
    for (const int v : samples.patch(s)) patches.fastest[s] = std::max(patches.fastest[s], local.fastest[v]);
  return patches;
}

/// What a window tells.
struct Window {
  AffineFit fit;
  double fastest = 0;  // speed in reach of it [m/s]
};

/// The window of `radius` around the point x, which is vertex v [m].
Window window_at(const Vec3& x, int v, double radius, const LocalMotion& local, const Patches& patches,
                 SampleWalk& walk) {
  WindowSums sums(x);
  double fastest = local.fastest[v];
  const SurfaceSamples& samples = patches.samples;
  for (const int s : walk.around(samples, x, samples.of_vertex[v], radius)) {
    const Vec3& y = samples.position[s];
    const double u = std::max(0.0, 1 - (y - x).squaredNorm() / (radius * radius));
    sums.add(patches.equations[s], y, u * u);
    fastest = std::max(fastest, patches.fastest[s]);
  }
  if (!(sums.weight() > 0)) sums.add(local.equations[v], x, 1);
  return {sums.solve(radius, local.normal[v]), fastest};
}

/// The smallest window around x that determines the tangential velocity, or the largest allowed.
Window sufficient_window(const Vec3& x, int v, const LocalMotion& local, const Patches& patches,
                         SampleWalk& walk) {
  const double scale = local.length_scale[v];
  for (double radius = kRadius * scale;; radius *= kRadiusGrowth) {
    Window window = window_at(x, v, radius, local, patches, walk);
    if (window.fit.determined >= kDetermined || radius * kRadiusGrowth > kLargestRadius * scale)
      return window;
  }
}

}  // namespace

void evaluate_regional(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                       VelocitySpans result) {
  const std::size_t n = points.position.size();
  const LocalMotion local = local_motion(field, points.position, options);
  const Patches patches = patches_of(local, points);
  std::ranges::fill(result.velocity, Vec3::Zero());
  std::ranges::fill(result.confidence, 0);
  tbb::enumerable_thread_specific<SampleWalk> walk;
  parallel_for(
      n,
      [&](std::size_t v) {
        if (!(local.length_scale[v] > 0)) return;
        const auto [fit, fastest] =
            sufficient_window(points.position[v], static_cast<int>(v), local, patches, walk.local());
        const Vec3 tangential = fit.velocity - fit.velocity.dot(local.normal[v]) * local.normal[v];
        result.velocity[v] = local.normal_velocity[v] + limited(tangential, options.speed_limit * fastest);
        result.confidence[v] = confidence(fit.determined, options.damping);
      },
      kPointsPerTask);
}

}  // namespace kappaflow
