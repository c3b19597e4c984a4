// nanoflann's tree over points that somebody else holds.
#pragma once

#include <cstdint>
#include <nanoflann.hpp>
#include <span>
#include <type_traits>

#include "core/types.h"

namespace kappaflow {

/// As nanoflann wants points.
struct PointCloud {
  std::span<const Vec3> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<int>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using PointTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointCloud>, PointCloud, 3>;

/// What a search in a radius fills: pairs of number and squared distance in nanoflann 1.4, items of its own
/// since 1.5.
template <class Scalar>
using PointsInReach =
    std::remove_reference_t<decltype(nanoflann::RadiusResultSet<Scalar, std::uint32_t>::m_indices_dists)>;

}  // namespace kappaflow
