#include "surface/motion/velocity_methods.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/errors.h"
#include "surface/motion/curvature_invariance.h"
#include "surface/motion/material.h"
#include "surface/motion/normal.h"
#include "surface/motion/regional.h"
#include "surface/motion/total.h"

namespace kappaflow {

std::span<const VelocityMethod> velocity_methods() {
  static const std::array<VelocityMethod, 7> methods{{
      {"normal", "along the normal only (Eq. 4)", evaluate_normal},
      {"total", "keeps the normal of each point (Eq. 5, Stam & Schmidt)", evaluate_total},
      {"curvature", "keeps normal and curvatures as well as both can be (Eq. 10)", evaluate_curvature},
      {"curvature-only", "keeps the curvatures K and H (Eqs. 7-8)", evaluate_curvature_only},
      {"curvature-first", "keeps the curvatures, and the normal where they leave it open",
       evaluate_curvature_first},
      {"regional", "fits affine motions to the neighbourhoods of points", evaluate_regional},
      {"material", "follows the particles' velocities (moving least squares)", evaluate_material},
  }};
  return methods;
}

const VelocityMethod& velocity_method(std::string_view name) {
  const auto methods = velocity_methods();
  const auto found = std::ranges::find(methods, name, &VelocityMethod::name);
  if (found != methods.end()) return *found;
  std::string names;
  for (const VelocityMethod& method : methods)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", method.name);
  throw InvalidInput(fmt::format("unknown velocity method '{}'; methods are {}", name, names));
}

std::vector<VelocityFunction> velocity_functions(std::span<const std::string> names) {
  std::vector<VelocityFunction> functions;
  for (const std::string& name : names) functions.push_back(velocity_method(name).evaluate);
  return functions;
}

}  // namespace kappaflow
