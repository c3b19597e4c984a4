// Ericson, "Real-Time Collision Detection", 2005, section 5.1.5.
#include "core/nearest_on_triangle.h"

#include "core/triangle_geometry.h"

namespace kappaflow {

NearestOnTriangle nearest_on_triangle(const std::array<Vec3, 3>& triangle, const Vec3& x) {
  using enum NearestOnTriangle::Feature;
  const auto& [a, b, c] = triangle;
  const Vec3 ab = b - a, ac = c - a, ax = x - a, bx = x - b, cx = x - c;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0 && d2 <= 0) return {a, corner_0};
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0 && d4 <= d3) return {b, corner_1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + d1 / (d1 - d3) * ab, edge_0};
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0 && d5 <= d6) return {c, corner_2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + d2 / (d2 - d6) * ac, edge_2};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return {b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b), edge_1};
  const double scale = 1 / (va + vb + vc);
  return {a + vb * scale * ab + vc * scale * ac, face};
}

Vec3 corner_weights(const std::array<Vec3, 3>& triangle, const Vec3& x) {
  const auto& [a, b, c] = triangle;
  const Vec3 area = twice_area_vector(a, b, c);
  const double square = area.squaredNorm();
  if (!(square > 0)) return Vec3::Constant(1.0 / 3);
  const double wb = twice_area_vector(a, x, c).dot(area) / square,
               wc = twice_area_vector(a, b, x).dot(area) / square;
  return {1 - wb - wc, wb, wc};
}

}  // namespace kappaflow
