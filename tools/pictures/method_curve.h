// Curves of velocity methods.
#pragma once

#include <string>
#include <string_view>

#include "tools/pictures/plot.h"

namespace kappaflow {

/// An empty curve of a method, with the same colour and mark in all plots.
Curve method_curve(std::string_view method);

}  // namespace kappaflow
