#include "tools/pictures/method_curve.h"

#include <algorithm>

#include "surface/motion/velocity_methods.h"

namespace kappaflow {

Curve method_curve(std::string_view method) {
  const auto methods = velocity_methods();
  const auto found = std::ranges::find(methods, method, &VelocityMethod::name);
  return {std::string(method), {}, Look::line, static_cast<int>(found - methods.begin())};
}

}  // namespace kappaflow
