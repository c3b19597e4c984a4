#include "surface/field/kernel_sums.h"

#include <algorithm>

namespace kappaflow {

namespace {

using Lanes = KernelHits::Lanes;

Vec3 vector(const Lanes (&v)[3]) {
  return {v[0].sum(), v[1].sum(), v[2].sum()};
}

}  // namespace

Jet FirstOrderKernelSums::jet(double threshold, double cloud_speed) const {
  Jet jet;
  const double sum = f.sum();
  jet.f = sum - threshold;
  jet.f_t = f_t.sum();
  jet.g = vector(g);
  jet.length_scale = sum > 0 ? sigma.sum() / sum : 0;
  jet.fastest_in_reach = std::max(fastest.maxCoeff(), cloud_speed);
  return jet;
}

Jet KernelSums::jet(double threshold, double cloud_speed) const {
  const auto matrix = [](const Lanes(&m)[6]) {
    Mat3 s;
    s << m[0].sum(), m[1].sum(), m[2].sum(),  //
        m[1].sum(), m[3].sum(), m[4].sum(),   //
        m[2].sum(), m[4].sum(), m[5].sum();
    return s;
  };
  Jet jet = first_order.jet(threshold, cloud_speed);
  jet.g_t = vector(g_t);
  jet.A = matrix(A);
  jet.A_t = matrix(A_t);
  jet.C = {.xxx = C[0].sum(),
           .xxy = C[1].sum(),
           .xxz = C[2].sum(),
           .xyy = C[3].sum(),
           .xyz = C[4].sum(),
           .xzz = C[5].sum(),
           .yyy = C[6].sum(),
           .yyz = C[7].sum(),
           .yzz = C[8].sum(),
           .zzz = C[9].sum()};
  return jet;
}

}  // namespace kappaflow
