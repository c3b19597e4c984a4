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

}  // namespace kappaflow
