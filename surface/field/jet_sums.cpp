#include "surface/field/jet_sums.h"

#include <algorithm>
#include <cmath>

namespace kappaflow {

Jet FirstOrderSums::jet(double threshold, double cloud_speed) const {
  Jet jet;
  const double sum = f.sum();
  jet.f = sum - threshold;
  jet.f_t = f_t.sum();
  jet.g = Vec3(g[0].sum(), g[1].sum(), g[2].sum());
  jet.length_scale = sum > 0 ? sigma.sum() / sum : 0;
  jet.fastest_in_reach = std::max(std::sqrt(fastest2.maxCoeff()), cloud_speed);
  return jet;
}

Jet JetSums::jet(double threshold, double cloud_speed) const {
  const auto symmetric = [](const Lanes(&m)[6], double diagonal) {
    Mat3 s;
    s << m[0].sum() + diagonal, m[1].sum(), m[2].sum(),  //
        m[1].sum(), m[3].sum() + diagonal, m[4].sum(),   //
        m[2].sum(), m[4].sum(), m[5].sum() + diagonal;
    return s;
  };
  Jet jet = first_order.jet(threshold, cloud_speed);
  jet.g_t = Vec3(g_t[0].sum(), g_t[1].sum(), g_t[2].sum());
  jet.A = symmetric(A, p1.sum());
  jet.A_t = symmetric(A_t, c1.sum());
  const double qx = p2_d[0].sum(), qy = p2_d[1].sum(), qz = p2_d[2].sum();
  jet.C = {.xxx = C[0].sum() + 3 * qx,
           .xxy = C[1].sum() + qy,
           .xxz = C[2].sum() + qz,
           .xyy = C[3].sum() + qx,
           .xyz = C[4].sum(),
           .xzz = C[5].sum() + qx,
           .yyy = C[6].sum() + 3 * qy,
           .yyz = C[7].sum() + qz,
           .yzz = C[8].sum() + qy,
           .zzz = C[9].sum() + 3 * qz};
  return jet;
}

}  // namespace kappaflow
