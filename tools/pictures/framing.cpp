#include "tools/pictures/framing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/quantile.h"

namespace kappaflow {
namespace {

/// What is within `reach` of place k, of so many.
template <class Visit>
void for_each_near(std::size_t k, std::size_t count, int reach, const Visit& visit) {
  for (int d = -reach; d <= reach; ++d)
    if (const auto at = static_cast<std::ptrdiff_t>(k) + d;
        at >= 0 && at < static_cast<std::ptrdiff_t>(count)) {
      const double s = d / (reach + 1.0), weight = (1 - s * s) * (1 - s * s);
      visit(static_cast<std::size_t>(at), weight);
    }
}

}  // namespace

Mat3 view_axes(const View& view) {
  Mat3 axes;
  axes.row(2) = view.from.normalized();
  axes.row(0) = view.up.cross(view.from).normalized();
  axes.row(1) = axes.row(2).cross(axes.row(0));
  return axes;
}

Framing framing(std::span<vtkPolyData* const> parts, const View& view, double left_out) {
  const Mat3 axes = view_axes(view);
  std::array<std::vector<double>, 3> along;
  for (vtkPolyData* const part : parts)
    for (vtkIdType i = 0; part != nullptr && i < part->GetNumberOfPoints(); ++i) {
      const Vec3 x = axes * Vec3(part->GetPoint(i));
      for (int a = 0; a < 3; ++a) along[static_cast<std::size_t>(a)].push_back(x[a]);
    }
  Framing box;
  if (along[0].empty()) return box;
  for (int a = 0; a < 3; ++a) {
    std::vector<double>& x = along[static_cast<std::size_t>(a)];
    const double low = quantile(x, left_out), high = quantile(x, 1 - left_out);
    box.centre[a] = 0.5 * (low + high);
    box.half[a] = 0.5 * (high - low);
  }
  return box;
}

std::vector<Framing> followed(std::span<const Framing> framings, int reach) {
  std::vector<Vec3> largest;
  for (std::size_t k = 0; k < framings.size(); ++k) {
    Vec3 half = framings[k].half;
    for_each_near(k, framings.size(), reach,
                  [&](std::size_t near, double) { half = half.cwiseMax(framings[near].half); });
    largest.push_back(half);
  }
  std::vector<Framing> result;
  for (std::size_t k = 0; k < framings.size(); ++k) {
    Framing sum{Vec3::Zero(), Vec3::Zero()};
    double weights = 0;
    for_each_near(k, framings.size(), reach, [&](std::size_t near, double weight) {
      sum.centre += weight * framings[near].centre;
      sum.half += weight * largest[near];
      weights += weight;
    });
    result.push_back({sum.centre / weights, sum.half / weights});
  }
  return result;
}

}  // namespace kappaflow
