#include "surface/topology/lattice_guard.h"

#include <Eigen/LU>
#include <cmath>

#include "surface/topology/simple_points.h"

namespace kappaflow {
namespace {

constexpr double kMostLatticePoints = 10000;  // [points] across a sweep, all axes together

}  // namespace

bool LatticeGuard::allows(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) const {
  const auto on_lattice = [&](const Vec3& p) -> Vec3 { return (p - origin_) / spacing_; };
  const Vec3 u = on_lattice(a), v = on_lattice(b), w = on_lattice(c), apex = on_lattice(x);
  const Vec3 lower = u.cwiseMin(v).cwiseMin(w).cwiseMin(apex).array().ceil(),
             upper = u.cwiseMax(v).cwiseMax(w).cwiseMax(apex).array().floor();
  if ((lower.array() > upper.array()).any()) return true;
  if (!((upper - lower).sum() < kMostLatticePoints)) return false;  // so far that no edit of a mesh is meant
  Mat3 edges;
  edges << v - u, w - u, apex - u;
  const double volume = edges.determinant();
  if (volume == 0) return true;
  if (!std::isfinite(volume)) return false;
  const Mat3 weights = edges.inverse();
  Vec3 p;
  for (p[2] = lower[2]; p[2] <= upper[2]; ++p[2])
    for (p[1] = lower[1]; p[1] <= upper[1]; ++p[1])
      for (p[0] = lower[0]; p[0] <= upper[0]; ++p[0]) {
        const Vec3 weight = weights * (p - u);
        if (weight.minCoeff() < 0 || weight.sum() > 1) continue;
        const ValueAndGradient here = at(p);
        const bool comes_inside = volume > 0;
        if (comes_inside != (here.f > 0) && !may_change_sides(p, here.f, here.g)) return false;
      }
  return true;
}

bool LatticeGuard::may_change_sides(const Vec3& point, double f, const Vec3& gradient) const {
  if (std::abs(f) > limit_ * gradient.norm()) return false;
  return is_simple(neighbourhood([&](int i, int j, int k) { return at(point + Vec3(i, j, k)).f > 0; }));
}

}  // namespace kappaflow
