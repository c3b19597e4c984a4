#include "tools/pictures/method_curve.h"

#include <algorithm>

#include "surface/tracker/surface_methods.h"

namespace kappaflow {

Curve method_curve(std::string_view method) {
  const auto methods = surface_methods();
  const auto found = std::ranges::find(methods, method, &NamedSurfaceMethod::name);
  return {std::string(method), {}, Look::line, static_cast<int>(found - methods.begin())};
}

}  // namespace kappaflow
