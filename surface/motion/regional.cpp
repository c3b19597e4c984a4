#include "surface/motion/regional.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "core/shared_loop.h"
#include "surface/mesh/surface_samples.h"
#include "surface/motion/affine_fit.h"
#include "surface/motion/normal.h"
#include "surface/motion/patch_agreement.h"
#include "surface/motion/pointwise.h"
#include "surface/motion/tangential_rows.h"

namespace kappaflow {
namespace {

// Of a window, in length scales at the point: what is not affine within it is averaged, see docs/regional.md.
constexpr double kRadius = 1.25, kLargestRadius = 2.5;
constexpr double kSampleSpacing = 0.55;  // [length scales] ten to twenty patches a window
constexpr double kRadiusGrowth = 1.414;  // [1] from one attempt to the next: twice the area
constexpr double kDetermined = 0.05;     // [1] AffineFit::determined that a window is content with
constexpr double kBlendRadius = 0.75;    // [length scales] within which patches' motions are blended
constexpr double kLeastNearness = 1e-3;  // [1] of a vertex's own patch, however far its sample is
constexpr std::size_t kPointsPerTask = 64, kBlendedPatchesPerTask = 16;

using WalkOfThread = tbb::enumerable_thread_specific<SampleWalk>;

/// What is known at every point before any window is looked at.
struct LocalMotion {
  std::vector<Vec3> normal;           // unit; zero where the field has no gradient
  std::vector<Vec3> normal_velocity;  // Eq. 4 [m/s]
  std::vector<double> length_scale;   // [m]; 0 where the field has no gradient
  std::vector<double> fastest;        // speed in reach [m/s]
  std::vector<MotionRows> rows;
};

/// Fills in what is known at point v, where the field has a gradient.
void add_local_motion(const Field& field, const Vec3& x, const VelocityOptions& options, std::size_t v,
                      LocalMotion& local) {
  const Field& pattern = field.pattern();
  StrainResponse strain;
  Jet jet = pattern.jet(x, strain);
  const Jet own = &pattern != &field ? field.first_order_jet(x) : jet;
  if (!has_gradient(own)) return;
  if (!has_gradient(jet)) jet = field.jet(x), strain = {};
  local.normal[v] = own.g.normalized();
  local.normal_velocity[v] = normal_velocity(own, options);
  local.length_scale[v] = jet.length_scale;
  local.fastest[v] = jet.fastest_in_reach;
  local.rows[v] = motion_rows(jet, strain, normal_velocity(jet, options));
}

/// Of the points of this process; of the others' only length scales and speeds.
LocalMotion local_motion(const Field& field, std::span<const Vec3> position, const VelocityOptions& options,
                         const ItemShares& shares) {
  const std::size_t n = position.size();
  LocalMotion local{.normal = std::vector<Vec3>(n, Vec3::Zero()),
                    .normal_velocity = std::vector<Vec3>(n, Vec3::Zero()),
                    .length_scale = std::vector<double>(n, 0.0),
                    .fastest = std::vector<double>(n, 0.0),
                    .rows = std::vector<MotionRows>(n)};
  shares.for_own(
      n, [&](std::size_t v) { add_local_motion(field, position[v], options, v, local); }, kPointsPerTask);
  shares.gather(std::span(local.length_scale));
  shares.gather(std::span(local.fastest));
  return local;
}

/// The surface in patches, each about a sample.
struct Patches {
  SurfaceSamples samples;
  std::vector<MotionEquations> equations;  // of a patch's points about its sample, weighted by area
  std::vector<double> fastest;             // the speed in reach of a patch [m/s]
  ItemShares shares;                       // a patch is that of the process with the sample
};

MotionEquations patch_equations(const LocalMotion& local, const SurfacePoints& points, const Vec3& sample,
                                std::span<const int> patch) {
  RowSums sums;
  for (const int v : patch)
    if (local.length_scale[v] > 0) sums.add(local.rows[v], points.position[v] - sample, points.area[v]);
  return sums.equations();
}

/// The patches of this process have all of their points from here on.
void complete_patches(const Field& field, std::span<const Vec3> position, const VelocityOptions& options,
                      const ItemShares& points, const Patches& patches, LocalMotion& local) {
  if (points.group() == nullptr) return;
  patches.shares.for_own(
      patches.samples.vertex.size(),
      [&](std::size_t s) {
        for (const int v : patches.samples.patch(s))
          if (!points.is_own(v)) add_local_motion(field, position[v], options, v, local);
      },
      kPointsPerTask);
}

Patches patches_of(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                   const ItemShares& shares, LocalMotion& local) {
  std::vector<double> spacing(local.length_scale.size());
  std::ranges::transform(local.length_scale, spacing.begin(), [](double L) { return kSampleSpacing * L; });
  Patches patches{surface_samples(points.position, points.rings, spacing), {}, {}, {}};
  const SurfaceSamples& samples = patches.samples;
  patches.shares = shares.of(samples.vertex);
  complete_patches(field, points.position, options, shares, patches, local);
  const std::size_t n = samples.vertex.size();
  patches.equations.resize(n);
  patches.shares.for_own(
      n,
      [&](std::size_t s) {
        patches.equations[s] = patch_equations(local, points, samples.position[s], samples.patch(s));
      },
      kPointsPerTask);
  patches.shares.gather(std::span(patches.equations));
  patches.fastest.assign(n, 0.0);
  parallel_for(n, [&](std::size_t s) {
    for (const int v : samples.patch(s)) patches.fastest[s] = std::max(patches.fastest[s], local.fastest[v]);
  });
  return patches;
}

/// The motions of patches, each fitted to the window around its sample.
struct PatchMotions {
  std::vector<AffineFit> fit;
  std::vector<double> fastest;  // speed in reach of the window [m/s]
};

MotionEquations equations_of(const MotionRows& rows) {
  RowSums sums;
  sums.add(rows, Vec3::Zero(), 1);
  return sums.equations();
}

/// From the window of `radius` around sample s [m]; fastest: the speed in its reach.
AffineFit window_fit(int s, double radius, const LocalMotion& local, const Patches& patches, SampleWalk& walk,
                     double& fastest) {
  const SurfaceSamples& samples = patches.samples;
  const Vec3& x = samples.position[s];
  WindowSums sums(x);
  fastest = 0;
  for (const int t : walk.around(samples, x, s, radius)) {
    const Vec3& y = samples.position[t];
    const double u = std::max(0.0, 1 - (y - x).squaredNorm() / (radius * radius));
    sums.add(patches.equations[t], y, u * u);
    fastest = std::max(fastest, patches.fastest[t]);
  }
  const int v = samples.vertex[s];
  if (!(sums.weight() > 0)) sums.add(equations_of(local.rows[v]), x, 1);
  return sums.solve(radius, local.normal[v]);
}

/// From the smallest window that determines the tangential velocity, or the largest allowed.
AffineFit patch_fit(int s, const LocalMotion& local, const Patches& patches, SampleWalk& walk,
                    double& fastest) {
  const double scale = local.length_scale[patches.samples.vertex[s]];
  if (!(scale > 0)) return {};
  for (double radius = kRadius * scale;; radius *= kRadiusGrowth) {
    AffineFit fit = window_fit(s, radius, local, patches, walk, fastest);
    if (fit.determined >= kDetermined || radius * kRadiusGrowth > kLargestRadius * scale) return fit;
  }
}

/// Tells of the others' patches all but AffineFit::information, which is long.
void gather_motions(const ItemShares& shares, PatchMotions& motions) {
  if (shares.group() == nullptr) return;
  struct Told {
    Vec3 velocity;
    Mat3 gradient;
    double determined, residual, radius, fastest;
  };
  std::vector<Told> told(motions.fit.size());
  for (std::size_t s = 0; s < told.size(); ++s) {
    const AffineFit& fit = motions.fit[s];
    told[s] = {fit.velocity, fit.gradient, fit.determined, fit.residual, fit.radius, motions.fastest[s]};
  }
  shares.gather(std::span(told));
  for (std::size_t s = 0; s < told.size(); ++s) {
    AffineFit& fit = motions.fit[s];
    fit.velocity = told[s].velocity;
    fit.gradient = told[s].gradient;
    fit.determined = told[s].determined;
    fit.residual = told[s].residual;
    fit.radius = told[s].radius;
    motions.fastest[s] = told[s].fastest;
  }
}

PatchMotions patch_motions(const LocalMotion& local, const Patches& patches, WalkOfThread& walk) {
  const std::size_t n = patches.equations.size();
  PatchMotions motions{std::vector<AffineFit>(n), std::vector<double>(n, 0.0)};
  patches.shares.for_own(
      n,
      [&](std::size_t s) {
        motions.fit[s] = patch_fit(static_cast<int>(s), local, patches, walk.local(), motions.fastest[s]);
      },
      kPointsPerTask);
  gather_motions(patches.shares, motions);
  std::vector<double> length_scale(n);
  parallel_for(n, [&](std::size_t s) { length_scale[s] = local.length_scale[patches.samples.vertex[s]]; });
  if (n > 0)
    agree(patches.samples, length_scale, std::ranges::max(motions.fastest), motions.fit, patches.shares);
  return motions;
}

/// What the patches around a vertex say of its motion.
struct Blend {
  Vec3 velocity = Vec3::Zero();
  double determined = 0, fastest = 0;  // as of the patches
};

/// Each patch counts by what it knows and the nearer the more.
Blend blended(const Vec3& x, int v, const LocalMotion& local, const Patches& patches,
              const PatchMotions& motions, SampleWalk& walk) {
  const SurfaceSamples& samples = patches.samples;
  const double radius = kBlendRadius * local.length_scale[v];
  Blend blend{.fastest = local.fastest[v]};
  double weights = 0, nearness = 0;
  for (const int s : walk.around(samples, x, samples.of_vertex[v], radius)) {
    const Vec3 d = x - samples.position[s];
    const AffineFit& fit = motions.fit[s];
    const double u = std::max(kLeastNearness, 1 - d.squaredNorm() / (radius * radius)), near = u * u;
    const double weight = near * fit.determined * fit.determined;
    blend.velocity += weight * (fit.velocity + fit.gradient * d);
    blend.fastest = std::max(blend.fastest, motions.fastest[s]);
    weights += weight;
    nearness += near;
  }
  if (!(weights > 0)) return blend;
  blend.velocity /= weights;
  blend.determined = std::sqrt(weights / nearness);
  return blend;
}

}  // namespace

void evaluate_regional(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                       VelocitySpans result) {
  const ItemShares shares = shares_in_slabs(points.position);
  LocalMotion local = local_motion(field, points.position, options, shares);
  const Patches patches = patches_of(field, points, options, shares, local);
  WalkOfThread walk;
  const PatchMotions motions = patch_motions(local, patches, walk);
  std::ranges::fill(result.velocity, Vec3::Zero());
  std::ranges::fill(result.confidence, 0);
  patches.shares.for_own(
      patches.equations.size(),
      [&](std::size_t s) {
        SampleWalk& walk_here = walk.local();
        for (const int v : patches.samples.patch(s)) {  // vertices of a patch look at the same samples
          if (!(local.length_scale[v] > 0)) continue;
          const Blend blend = blended(points.position[v], v, local, patches, motions, walk_here);
          const Vec3 tangential = blend.velocity - blend.velocity.dot(local.normal[v]) * local.normal[v];
          result.velocity[v] =
              local.normal_velocity[v] + limited(tangential, options.speed_limit * blend.fastest);
          result.confidence[v] = confidence(blend.determined, options.damping);
        }
      },
      kBlendedPatchesPerTask);
  const ItemShares by_patch = patches.shares.of(patches.samples.of_vertex);
  by_patch.gather(result.velocity);
  by_patch.gather(result.confidence);
}

}  // namespace kappaflow
