// Where the components of symmetric tensors stand that are kept once each.
#pragma once

namespace kappaflow {

/// The place of a component of a symmetric tensor among those with ascending axes, xx xy xz yy yz zz and
/// likewise xxx xxy ... zzz and so on. axes: 0, 1, 2 for x, y, z, as many as the tensor's order, in any
/// order.
template <class... Axis>
constexpr int symmetric_place(Axis... axes) {
  const int not_x = (0 + ... + static_cast<int>(axes > 0)), z = (0 + ... + static_cast<int>(axes == 2));
  return not_x * (not_x + 1) / 2 + z;
}

/// Calls visit.operator()<a, b>() for the six pairs of axes xx xy xz yy yz zz, so that loops over components
/// become straight code.
template <class Visit>
constexpr void for_pairs_of_axes(const Visit& visit) {
  visit.template operator()<0, 0>();
  visit.template operator()<0, 1>();
  visit.template operator()<0, 2>();
  visit.template operator()<1, 1>();
  visit.template operator()<1, 2>();
  visit.template operator()<2, 2>();
}

}  // namespace kappaflow
