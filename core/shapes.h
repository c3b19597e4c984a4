// Simple bodies, by their measures.
#pragma once

#include "core/types.h"

namespace kappaflow {

struct BoxShape {
  Vec3 lower, upper;  ///< corners [m]
};
struct SphereShape {
  Vec3 center;        ///< [m]
  double radius = 0;  ///< [m]
};
/// A round bar.
struct CylinderShape {
  Vec3 from, to;      ///< centres of its ends [m]
  double radius = 0;  ///< [m]
};

}  // namespace kappaflow
