// What the validations of the solver share: the liquid of a scene at any resolution, and power laws
// through measurements.
//
// A validation is an experiment whose name begins with "validate-". Its scene is one that `kappaflow run`
// takes; its limits follow from the accuracy that the method promises.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/types.h"
#include "scenes/prepared_scene.h"
#include "solver/fluid_solver.h"
#include "tools/experiments/experiment.h"
#include "tools/pictures/report.h"

namespace kappaflow {

inline constexpr std::string_view kValidationPrefix = "validate-";

/// The scene at another resolution.
Scene with_spacing(Scene scene, double spacing);

/// The spacings of a scene with its own times each of these: "0.05 m, 0.025 m".
std::string spacings_text(const Scene& scene, std::span<const double> factors);

/// "spacing 0.05 m"
std::string at_spacing(double spacing);

/// The liquid of a scene between its walls, with its bodies, without a surface.
FluidSolver make_liquid(const Scene& scene);
FluidSolver make_liquid(const PreparedScene& prepared);

/// Steps until `time` [s]; calls watch after each step.
using LiquidWatch = std::function<void(const FluidStep&)>;
void advance(
    FluidSolver& liquid, double time, const LiquidWatch& watch = [](const FluidStep&) {});

/// y = coefficient x^exponent.
struct PowerLaw {
  double exponent = 0, coefficient = 0;
};
/// Least squares on the logarithms. Requires two or more points with positive coordinates and different x.
/// With x a spacing and y an error the exponent is the order of convergence.
PowerLaw fit_power_law(std::span<const Vec2> points);

/// Root mean square of y - reference(x) over the points.
double rms_difference(std::span<const Vec2> points, const std::function<double(double)>& reference);

/// reference at `count` even places from first to last, as a curve of a plot.
std::vector<Vec2> sampled(const std::function<double(double)>& reference, double first, double last,
                          int count = 101);

/// A header line, and a line a row with six digits. Every row has as many numbers as the header has names.
std::string csv_text(const std::string& header, const std::vector<std::vector<double>>& rows);

}  // namespace kappaflow
