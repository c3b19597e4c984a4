// Eq. 10 by a search that starts somewhere and stops somewhere, as the paper's does.
#pragma once

#include "surface/motion/velocity.h"
#include "tools/experiments/tangential_minimum.h"

namespace kappaflow {

/// Where a search for the tangential velocity starts: at rest, at the tangential part of the velocity that
/// the vertex had last, or at that of total velocity (Eq. 5).
enum class SearchStart { zero, last, total };

inline constexpr Named<SearchStart> kSearchStarts[] = {
    {"zero", SearchStart::zero}, {"last", SearchStart::last}, {"total", SearchStart::total}};

/// tolerance: share of the sum of squares that an iteration must gain for another one to follow; lines are
/// searched to its square root, or to 1e-3 of their length where that is coarser.
struct TangentialSearch {
  Minimiser minimiser = Minimiser::closed_form;
  SearchStart start = SearchStart::zero;
  double tolerance = 0;
};

/// Eq. 10 (method `curvature`) by that search; by the closed form it is evaluate_curvature(). Of `last` it
/// keeps the velocities from one call to the next: for one tracker, whose vertices stay the same.
VelocityFunction searched_curvature(const TangentialSearch& search);

}  // namespace kappaflow
