#include "scenes/view.h"

#include <Eigen/Geometry>

namespace kappaflow {

View view_with(const Vec3& up) {
  return {Eigen::Quaterniond::FromTwoVectors(View{}.up, up) * View{}.from, up};
}

bool is_view(const View& view) {
  return view.from.norm() > 1e-12 && view.up.norm() > 1e-12 &&
         view.from.normalized().cross(view.up.normalized()).norm() > 1e-3;
}

}  // namespace kappaflow
