// What somebody may have meant who wrote a name that there is not.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace kappaflow {

/// " (did you mean "x"?)" for the name that differs in the fewest characters, "x" or "y" where two or three
/// do; nothing where none is near, or more are.
std::string suggestion(std::string_view found, std::span<const std::string_view> names);

}  // namespace kappaflow
