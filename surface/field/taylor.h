// Truncated Taylor polynomials in three variables: arithmetic on a function together with all its derivatives
// up to a degree, so that a formula written once yields them without differences. For fields of formulas.
#pragma once

#include <array>
#include <cmath>
#include <utility>

#include "surface/field/jet.h"
#include "surface/field/taylor_terms.h"

namespace kappaflow {

/// A function of d in R^3 near d = 0: sum over |a| <= Degree of c_a d^a, c_a = (derivative a at 0) / a!.
/// Arithmetic, sqrt, exp, sine and cosine are exact up to the degree, which is 1, 2 or 3; higher terms are
/// dropped.
template <int Degree>
class Taylor {
 public:
  static_assert(Degree >= 1 && Degree <= 3);

  Taylor() = default;  ///< coefficients are not set
  /// The variable number `axis` about x: x + d_axis.
  static Taylor variable(double x, int axis) {
    Taylor t(Coefficients::Zero());
    t.c_[0] = x;
    t.c_[1 + axis] = 1;
    return t;
  }

  double value() const { return c_[0]; }
  Vec3 gradient() const { return c_.template segment<3>(1); }
  Mat3 hessian() const {
    static_assert(Degree >= 2);
    Mat3 m;
    m << 2 * c_[4], c_[5], c_[6], c_[5], 2 * c_[7], c_[8], c_[6], c_[8], 2 * c_[9];
    return m;
  }
  ThirdDerivatives third_derivatives() const {
    static_assert(Degree == 3);
    return {6 * c_[10], 2 * c_[11], 2 * c_[12], 2 * c_[13], c_[14],
            2 * c_[15], 6 * c_[16], 2 * c_[17], 2 * c_[18], 6 * c_[19]};
  }
  /// The derivative along `axis`, which is of one degree less.
  Taylor<Degree - 1> derivative(int axis) const {
    Taylor<Degree - 1> result;
    for (std::size_t i = 0; i < taylor::count(Degree - 1); ++i) {
      taylor::Exponents raised = taylor::kExponents[i];
      ++raised[axis];
      result.c_[i] = raised[axis] * c_[taylor::index_of(raised)];
    }
    return result;
  }

  Taylor& operator+=(const Taylor& other) {
    c_ += other.c_;
    return *this;
  }
  Taylor& operator-=(const Taylor& other) {
    c_ -= other.c_;
    return *this;
  }
  friend Taylor operator-(const Taylor& a, const Taylor& b) { return Taylor(a.c_ - b.c_); }
  friend Taylor operator*(double s, const Taylor& a) { return Taylor(s * a.c_); }
  friend Taylor operator-(const Taylor& a) { return Taylor(-a.c_); }
  friend Taylor operator*(const Taylor& a, double s) { return Taylor(s * a.c_); }
  friend Taylor operator+(const Taylor& a, double s) { return a.plus(s); }
  friend Taylor operator+(double s, const Taylor& a) { return a.plus(s); }
  friend Taylor operator-(const Taylor& a, double s) { return a.plus(-s); }
  friend Taylor operator-(double s, const Taylor& a) { return (-a).plus(s); }
  friend Taylor operator*(const Taylor& a, const Taylor& b) { return product<0, 0>(a, b); }
  friend Taylor operator+(Taylor a, const Taylor& b) { return a += b; }

  /// b != 0, as in all quotients.
  friend Taylor operator/(double s, const Taylor& b) {
    const double r = 1 / b.c_[0];
    return b.function({s * r, -s * r * r, 2 * s * r * r * r, -6 * s * r * r * r * r});
  }
  friend Taylor operator/(const Taylor& a, const Taylor& b) { return a * (1.0 / b); }
  friend Taylor operator/(const Taylor& a, double s) { return Taylor(a.c_ / s); }
  /// a > 0.
  friend Taylor sqrt(const Taylor& a) {
    const double s = std::sqrt(a.c_[0]), r = 1 / a.c_[0];
    return a.function({s, s * r / 2, -s * r * r / 4, 3 * s * r * r * r / 8});
  }
  friend Taylor exp(const Taylor& a) {
    const double e = std::exp(a.c_[0]);
    return a.function({e, e, e, e});
  }

  /// {sin a, cos a}: with a = a_0 + n, n^4 = 0, sin n = n - n^3/6 and cos n = 1 - n^2/2.
  friend std::pair<Taylor, Taylor> sine_and_cosine(const Taylor& a) {
    const Taylor n = a.plus(-a.c_[0]), n2 = product<1, 1>(n, n), n3 = product<2, 1>(n2, n);
    const Coefficients sine = n.c_ - n3.c_ / 6, cosine = Taylor(-0.5 * n2.c_).plus(1).c_;
    const double s = std::sin(a.c_[0]), c = std::cos(a.c_[0]);
    return {Taylor(s * cosine + c * sine), Taylor(c * cosine - s * sine)};
  }

 private:
  template <int>
  friend class Taylor;
  using Coefficients = Eigen::Array<double, static_cast<int>(taylor::count(Degree)), 1>;

  explicit Taylor(const Coefficients& c) : c_(c) {}

  Taylor plus(double s) const {
    Taylor t = *this;
    t.c_[0] += s;
    return t;
  }

  /// g(this), of a function g of one variable whose value and derivatives at value() are given. Its value
  /// stands even where derivatives are infinite.
  Taylor function(const std::array<double, 4>& g) const {
    const Taylor n = plus(-c_[0]);
    Coefficients c = g[1] * n.c_;
    if constexpr (Degree >= 2) {
      const Taylor n2 = product<1, 1>(n, n);
      c += g[2] / 2 * n2.c_;
      if constexpr (Degree >= 3) c += g[3] / 6 * product<2, 1>(n2, n).c_;
    }
    c[0] = g[0];
    return Taylor(c);
  }

  /// a b where the terms of a below degree A, and of b below degree B, vanish. Unrolled at compile time, and
  /// by coefficient, so that each is summed in a register.
  template <int A, int B>
  static Taylor product(const Taylor& a, const Taylor& b) {
    Taylor result;
    [&]<std::size_t... K>(std::index_sequence<K...>) {
      ((result.c_[K] = sum_of_terms<A, B, K>(a, b)), ...);
    }
    (std::make_index_sequence<taylor::count(Degree)>());
    return result;
  }
  template <int A, int B, std::size_t K>
  static double sum_of_terms(const Taylor& a, const Taylor& b) {
    static constexpr auto kTerms = taylor::product_terms<Degree, A, B, K>();
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      return (0.0 + ... + (a.c_[kTerms[I].first] * b.c_[kTerms[I].second]));
    }
    (std::make_index_sequence<kTerms.size()>());
  }

  Coefficients c_;
};

/// The same for a plain number, so that formulas serve both.
inline std::pair<double, double> sine_and_cosine(double a) {
  return {std::sin(a), std::cos(a)};
}

/// The three variables about x, to put into a formula.
template <int Degree>
std::array<Taylor<Degree>, 3> taylor_variables(const Vec3& x) {
  return {Taylor<Degree>::variable(x[0], 0), Taylor<Degree>::variable(x[1], 1),
          Taylor<Degree>::variable(x[2], 2)};
}

/// The jet of a field from f and its partial time derivative f_t. length_scale [m]; speed: the largest of
/// what makes the field here [m/s].
inline Jet jet_of(const Taylor<3>& f, const Taylor<2>& f_t, double length_scale, double speed) {
  return {f.value(),     f.gradient(), f.hessian(), f.third_derivatives(), f_t.value(), f_t.gradient(),
          f_t.hessian(), length_scale, speed};
}

}  // namespace kappaflow
