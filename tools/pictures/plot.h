// Plots of numbers as journals print them, drawn by gnuplot.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// How a curve is drawn. line: in a colour, with marks here and there (at every point where these are few);
/// reference: a thin black line, what others are held against; points: marks without a line.
enum class Look { line, reference, points };

/// Points (x, y); those that are not finite leave a gap.
struct Curve {
  std::string title;  ///< beside the curve's end, or in a list
  std::vector<Vec2> points;
  Look look = Look::line;
  int style = -1;  ///< number of colour and mark, 0 to 7; -1: its place among the plot's curves
};

/// One pair of axes. Both are logarithmic where that tells more (see spans_decades()), or always; then values
/// not above 0 leave a gap.
struct Plot {
  std::string title, x_label, y_label;
  std::vector<Curve> curves;
  bool log_y = false;  ///< always
  bool log_x = false;  ///< always; else never
};

/// Names of colour and mark, for users of the same in other plots.
inline constexpr int kPlotStyles = 10;

/// Writes `name`.gp, a gnuplot script with its data in it, and from it `name`.png (200 dpi), .pdf and .svg:
/// one plot as wide as a journal's column, 89 mm, or more in pairs across the page, 183 mm. Throws IoError
/// where gnuplot is missing or fails.
void draw_plots(const std::filesystem::path& folder, const std::string& name, std::span<const Plot> plots);

/// Throws IoError with the way to install it unless gnuplot can be run.
void require_gnuplot();

}  // namespace kappaflow
