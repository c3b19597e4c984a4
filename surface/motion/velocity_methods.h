// The velocity methods by the names that scenes and the command line call them.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "surface/motion/velocity.h"

namespace kappaflow {

/// A velocity method by name.
struct VelocityMethod {
  std::string_view name;
  std::string_view summary;  ///< one line for help texts, with the equation
  VelocityFunction evaluate;
};

/// All methods, in the order in which help texts list them.
std::span<const VelocityMethod> velocity_methods();

/// The method of that name. Throws InvalidInput that lists the names otherwise.
const VelocityMethod& velocity_method(std::string_view name);

/// The functions of the methods of these names. Throws as velocity_method() does.
std::vector<VelocityFunction> velocity_functions(std::span<const std::string> names);

}  // namespace kappaflow
