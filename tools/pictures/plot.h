// Plots of numbers, drawn by gnuplot.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// Points that are joined by a line.
struct Curve {
  std::string title;         ///< in the legend
  std::vector<Vec2> points;  ///< (x, y); those that are not finite leave a gap
};

/// One pair of axes.
struct Plot {
  std::string title, x_label, y_label;
  std::vector<Curve> curves;
  bool log_y = false;    ///< y not above 0 leaves a gap
  bool scatter = false;  ///< points without lines, x logarithmic as well
};

/// Writes `name`.gp, a gnuplot script with its data in it, and from it `name`.png with the plots side by
/// side. Throws IoError where gnuplot is missing or fails.
void draw_plots(const std::filesystem::path& folder, const std::string& name, std::span<const Plot> plots);

/// Throws IoError with the way to install it unless gnuplot can be run.
void require_gnuplot();

}  // namespace kappaflow
