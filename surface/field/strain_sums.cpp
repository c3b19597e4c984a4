#include "surface/field/strain_sums.h"

#include <algorithm>
#include <array>

#include "surface/field/symmetric_place.h"

namespace kappaflow {
namespace {

/// The symmetric matrix of entry<a, b>().
template <class Entry>
Mat3 symmetric_matrix(const Entry& entry) {
  Mat3 M;
  for_pairs_of_axes([&]<int a, int b>() { M(a, b) = M(b, a) = entry.template operator()<a, b>(); });
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
  R.f = symmetric_matrix([&]<int a, int b>() { return dd[symmetric_place(a, b)]; });
  for_pairs_of_axes([&]<int c, int e>() {
    if constexpr (c == e)
      R.g[c] = symmetric_matrix([&]<int a, int b>() {
        return ddd[symmetric_place(a, b, c)] + (a == c ? g[b] : 0) + (b == c ? g[a] : 0);
      });
    R.A[symmetric_place(c, e)] = symmetric_matrix([&]<int a, int b>() {
      constexpr int kOfFirst = (a == c && b == e) + (b == c && a == e);
      return dddd[symmetric_place(a, b, c, e)] + (c == e ? B(a, b) : 0) +  //
             (b == e ? B(c, a) : 0) + (a == e ? B(c, b) : 0) + (c == a ? B(b, e) : 0) +
             (c == b ? B(a, e) : 0) + kOfFirst * s1;
    });
  });
  return R;
}

}  // namespace kappaflow
