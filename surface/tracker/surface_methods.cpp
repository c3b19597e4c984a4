#include "surface/tracker/surface_methods.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/errors.h"
#include "surface/motion/velocity_methods.h"

namespace kappaflow {
namespace {

std::vector<NamedSurfaceMethod> all_methods() {
  std::vector<NamedSurfaceMethod> methods;
  for (const VelocityMethod& method : velocity_methods())
    methods.push_back({method.name, method.summary, method.evaluate});
  methods.push_back(
      {"fresh-nearest", "new mesh each frame, texture of the last one's nearest point", FreshMesh::nearest});
  methods.push_back({"fresh-particles", "new mesh each frame, texture by where particles were first",
                     FreshMesh::particles});
  methods.push_back(
      {"fresh-grid", "new mesh each frame, texture carried on a grid (BFECC)", FreshMesh::grid});
  return methods;
}

}  // namespace

std::span<const NamedSurfaceMethod> surface_methods() {
  static const std::vector<NamedSurfaceMethod> methods = all_methods();
  return methods;
}

std::vector<std::string_view> surface_method_names() {
  std::vector<std::string_view> names;
  for (const NamedSurfaceMethod& method : surface_methods()) names.push_back(method.name);
  return names;
}

std::vector<SurfaceMethod> surface_methods_named(std::span<const std::string> names) {
  std::vector<SurfaceMethod> methods;
  for (const std::string& name : names) {
    const auto found = std::ranges::find(surface_methods(), name, &NamedSurfaceMethod::name);
    if (found == surface_methods().end())
      throw InvalidInput(
          fmt::format("unknown method '{}'; methods are {}", name, fmt::join(surface_method_names(), ", ")));
    methods.push_back(found->method);
  }
  return methods;
}

}  // namespace kappaflow
