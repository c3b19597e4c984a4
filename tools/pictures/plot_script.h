// Plots as a script for gnuplot.
#pragma once

#include <span>
#include <string>

#include "tools/pictures/plot.h"

namespace kappaflow {

/// A script that draws `name`.png, .pdf and .svg, or, where the variable `suffix` is set, files with it
/// behind these names.
std::string plot_script(const std::string& name, std::span<const Plot> plots);

}  // namespace kappaflow
