// K and H of an implicit surface (Fujisawa et al. 2011, Eqs. 6 and 9) and their derivatives, by the chain
// rule.
#include "surface/field/curvature.h"

#include <array>
#include <cmath>

namespace kappaflow {

namespace {

/// What the curvatures and their changes share. K = P / |g|^4 with P = g^T adj(A) g, and H = -N / (2 |g|^3)
/// with N = tr(A) |g|^2 - g^T A g.
struct CurvatureTerms {
  explicit CurvatureTerms(const Jet& jet)
      : g(jet.g),
        A(jet.A),
        Ag(jet.A * jet.g),
        g2(jet.g.squaredNorm()),
        trace(jet.A.trace()),
        gAg(jet.g.dot(Ag)),
        adj_g(A * Ag - trace * Ag + 0.5 * (trace * trace - A.squaredNorm()) * g) {}

  const Vec3& g;
  const Mat3& A;
  Vec3 Ag;
  double g2, trace, gAg;
  Vec3 adj_g;  // adj(A) g
};

/// dK and dH for the change (dg, dA) of gradient and Hessian, where (K, H) are the curvatures.
/// g^T d adj(A) g is expanded from d adj = dA A + A dA - tr(dA) A - tr(A) dA + (tr A tr dA - tr(A dA)) I.
std::array<double, 2> curvature_change(const CurvatureTerms& t, double K, double H, const Vec3& dg,
                                       const Mat3& dA) {
  const Vec3 dA_g = dA * t.g;
  const double d_trace = dA.trace(), g_dA_g = t.g.dot(dA_g), half_dg2 = t.g.dot(dg);
  const double d_adj = 2 * dA_g.dot(t.Ag) - d_trace * t.gAg - t.trace * g_dA_g +
                       (t.trace * d_trace - t.A.cwiseProduct(dA).sum()) * t.g2;
  const double dP = 2 * dg.dot(t.adj_g) + d_adj;
  const double dN = d_trace * t.g2 + 2 * t.trace * half_dg2 - 2 * dg.dot(t.Ag) - g_dA_g;
  return {dP / (t.g2 * t.g2) - 4 * K * half_dg2 / t.g2,
          -dN / (2 * t.g2 * std::sqrt(t.g2)) - 3 * H * half_dg2 / t.g2};
}

}  // namespace

CurvatureJet curvature_jet(const Jet& jet) {
  const CurvatureTerms terms(jet);
  CurvatureJet c;
  c.K = terms.g.dot(terms.adj_g) / (terms.g2 * terms.g2);
  c.H = (terms.gAg - terms.trace * terms.g2) / (2 * terms.g2 * std::sqrt(terms.g2));
  for (int k = 0; k < 3; ++k) {
    const auto [dK, dH] = curvature_change(terms, c.K, c.H, jet.A.col(k), jet.C.contract(Vec3::Unit(k)));
    c.grad_K[k] = dK;
    c.grad_H[k] = dH;
  }
  const auto [K_t, H_t] = curvature_change(terms, c.K, c.H, jet.g_t, jet.A_t);
  c.K_t = K_t;
  c.H_t = H_t;
  return c;
}

}  // namespace kappaflow
