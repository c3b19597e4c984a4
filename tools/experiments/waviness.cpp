#include "tools/experiments/waviness.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"

namespace kappaflow {
namespace {

constexpr int kDegree = 4, kTerms = (kDegree + 1) * (kDegree + 2) / 2;
using Terms = Eigen::Matrix<double, kTerms, 1>;

/// u^i v^j for all i + j <= kDegree.
Terms terms(double u, double v) {
  Terms result;
  for (int i = 0, k = 0; i <= kDegree; ++i)
    for (int j = 0; i + j <= kDegree; ++j) result[k++] = std::pow(u, i) * std::pow(v, j);
  return result;
}

/// Their derivatives along u and v.
std::pair<Terms, Terms> slopes(double u, double v) {
  Terms du, dv;
  for (int i = 0, k = 0; i <= kDegree; ++i)
    for (int j = 0; i + j <= kDegree; ++j, ++k) {
      du[k] = i > 0 ? i * std::pow(u, i - 1) * std::pow(v, j) : 0;
      dv[k] = j > 0 ? j * std::pow(u, i) * std::pow(v, j - 1) : 0;
    }
  return {du, dv};
}

double angle(const Vec3& a, const Vec3& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

double rms(std::span<const double> values) {
  double squares = 0;
  for (const double v : values) squares += v * v;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

std::vector<Crossing> crossings(const Field& field, std::span<const Vec3> from, double farthest,
                                const auto& direction) {
  std::vector<Crossing> at(from.size());
  parallel_for(from.size(), [&](std::size_t i) { at[i] = crossing(field, from[i], direction(i), farthest); });
  return at;
}

/// Heights and angles to what is expected, one of each a ray.
Waviness waviness_of(std::span<const Crossing> at, std::span<const double> height,
                     std::span<const double> angles) {
  Waviness result{.height = rms(height), .normals = rms(angles) * 180 / std::numbers::pi, .distances = {}};
  for (const Crossing& c : at) result.distances.push_back(c.distance);
  return result;
}

}  // namespace

Crossing crossing(const Field& field, const Vec3& x, const Vec3& direction, double farthest) {
  double inside = 0, outside = farthest;
  if (!(field.value_and_gradient(x).f > 0)) return {};
  while (outside - inside > 1e-7 * farthest) {
    const double middle = 0.5 * (inside + outside);
    (field.value_and_gradient(x + middle * direction).f > 0 ? inside : outside) = middle;
  }
  return {inside, -field.value_and_gradient(x + inside * direction).g.normalized()};
}

Waviness waviness(const Field& field, std::span<const Vec3> from, std::span<const Vec3> direction,
                  double farthest) {
  const std::vector<Crossing> at =
      crossings(field, from, farthest, [&](std::size_t i) { return direction[i]; });
  double mean = 0;
  for (const Crossing& c : at) mean += c.distance / static_cast<double>(at.size());
  std::vector<double> height, angles;
  for (std::size_t i = 0; i < at.size(); ++i) {
    height.push_back(at[i].distance - mean);
    angles.push_back(angle(at[i].normal, direction[i]));
  }
  return waviness_of(at, height, angles);
}

Waviness waviness_of_graph(const Field& field, std::span<const Vec3> from, int a, int b, const Vec3& up,
                           double farthest) {
  const std::vector<Crossing> at = crossings(field, from, farthest, [&](std::size_t) { return up; });
  const auto n = static_cast<Eigen::Index>(at.size());
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : from) middle += x / static_cast<double>(n);
  Eigen::MatrixXd rows(n, kTerms);
  Eigen::VectorXd distance(n);
  const auto place = [&](Eigen::Index i) { return Vec3((from[i] - middle) / farthest); };
  for (Eigen::Index i = 0; i < n; ++i) {
    rows.row(i) = terms(place(i)[a], place(i)[b]);
    distance[i] = at[i].distance;
  }
  const Terms polynomial = rows.colPivHouseholderQr().solve(distance);
  const Eigen::VectorXd missing = distance - rows * polynomial;
  std::vector<double> angles;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto [du, dv] = slopes(place(i)[a], place(i)[b]);
    Vec3 normal = up;
    normal[a] -= du.dot(polynomial) / farthest;
    normal[b] -= dv.dot(polynomial) / farthest;
    angles.push_back(angle(at[i].normal, normal.normalized()));
  }
  return waviness_of(at, {missing.data(), at.size()}, angles);
}

}  // namespace kappaflow
