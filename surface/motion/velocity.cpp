#include "surface/motion/velocity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <type_traits>

#include "core/errors.h"

// A line a method, in the order in which help texts list them: its name, what it does, and its function,
// which the line declares too.
#define KAPPAFLOW_VELOCITY_METHODS(METHOD)                                                               \
  METHOD("normal", "along the normal only (Eq. 4)", evaluate_normal)                                     \
  METHOD("total", "keeps the normal of each point (Eq. 5, Stam & Schmidt)", evaluate_total)              \
  METHOD("curvature", "keeps normal and curvatures as well as both can be (Eq. 10)", evaluate_curvature) \
  METHOD("curvature-only", "keeps the curvatures K and H (Eqs. 7-8)", evaluate_curvature_only)           \
  METHOD("curvature-first", "keeps the curvatures, and the normal where they leave it open",             \
         evaluate_curvature_first)                                                                       \
  METHOD("regional", "fits one affine motion to a neighbourhood of each point", evaluate_regional)       \
  METHOD("material", "follows the particles' velocities (moving least squares)", evaluate_material)

namespace kappaflow {

#define DECLARE(name, summary, evaluate) std::remove_pointer_t<VelocityFunction> evaluate;
KAPPAFLOW_VELOCITY_METHODS(DECLARE)
#undef DECLARE

std::span<const VelocityMethod> velocity_methods() {
#define ROW(name, summary, evaluate) VelocityMethod{name, summary, evaluate},
  static constexpr std::array methods{KAPPAFLOW_VELOCITY_METHODS(ROW)};
#undef ROW
  return methods;
}

const VelocityMethod& velocity_method(std::string_view name) {
  const auto methods = velocity_methods();
  const auto found =
      std::find_if(methods.begin(), methods.end(), [&](const auto& m) { return m.name == name; });
  if (found != methods.end()) return *found;
  std::string names;
  for (const VelocityMethod& method : methods)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", method.name);
  throw InvalidInput(fmt::format("unknown velocity method '{}'; methods are {}", name, names));
}

}  // namespace kappaflow
