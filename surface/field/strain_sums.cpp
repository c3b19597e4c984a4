#include "surface/field/strain_sums.h"

#include <algorithm>
#include <array>

#include "surface/field/symmetric_place.h"

namespace kappaflow {
namespace {

/// Kronecker's delta.
constexpr double delta(int a, int b) {
  return a == b ? 1 : 0;
}

/// The matrix M of what is M : E = sum_ab M_ab E_ab.
template <class Entry>
Mat3 matrix_of(const Entry& entry) {
  Mat3 M;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) M(a, b) = entry(a, b);
  return M;
}

template <std::size_t N>
std::array<double, N> sums_of(const ParticleHits::Lanes (&lanes)[N]) {
  std::array<double, N> sums;
  std::transform(lanes, lanes + N, sums.begin(), [](const ParticleHits::Lanes& sum) { return sum.sum(); });
  return sums;
}

}  // namespace

StrainResponse StrainSums::response(const Jet& jet) const {
  const std::array dd = sums_of(p1_dd);      // sum w b1 d d
  const std::array ddd = sums_of(p2_ddd);    // sum w b2 d d d
  const std::array dddd = sums_of(p3_dddd);  // sum w b3 d d d d
  const double s1 = p1.sum();                // sum w b1
  const Vec3& g = jet.g;
  const Mat3 B = jet.A - s1 * Mat3::Identity();
  StrainResponse R;
  R.f = matrix_of([&](int a, int b) { return dd[symmetric_place(a, b)]; });
  for (int c = 0; c < 3; ++c)
    R.g[c] = matrix_of([&](int a, int b) {
      return ddd[symmetric_place(a, b, c)] + delta(a, c) * g[b] + delta(b, c) * g[a];
    });
  for (int c = 0; c < 3; ++c)
    for (int e = c; e < 3; ++e)
      R.A[symmetric_place(c, e)] = matrix_of([&](int a, int b) {
        return dddd[symmetric_place(a, b, c, e)] + delta(c, e) * B(a, b) +  //
               delta(b, e) * B(c, a) + delta(a, e) * B(c, b) + delta(c, a) * B(b, e) + delta(c, b) * B(a, e) +
               s1 * (delta(a, c) * delta(b, e) + delta(b, c) * delta(a, e));
      });
  return R;
}

}  // namespace kappaflow
