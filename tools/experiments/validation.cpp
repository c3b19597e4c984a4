#include "tools/experiments/validation.h"

#include <fmt/format.h>

#include <cmath>

namespace kappaflow {
namespace {

// Times that differ by less are the same: rounding in the solver's sum of time steps [s].
constexpr double kTimeTolerance = 1e-12;

}  // namespace

Scene with_spacing(Scene scene, double spacing) {
  scene.fluid.spacing = spacing;
  return scene;
}

std::string spacings_text(const Scene& scene, std::span<const double> factors) {
  std::vector<std::string> spacings;
  for (const double factor : factors)
    spacings.push_back(fmt::format("{:.3g} m", factor * scene.fluid.spacing));
  return fmt::format("{}", fmt::join(spacings, ", "));
}

std::string at_spacing(double spacing) {
  return fmt::format("spacing {:.3g} m", spacing);
}

FluidSolver make_liquid(const Scene& scene) {
  return make_liquid(prepare(scene));
}

FluidSolver make_liquid(const PreparedScene& prepared) {
  const FluidParticlesAtStart& start = prepared.start;
  return {prepared.scene.fluid, start.position, start.velocity,    prepared.walls,
          start.fluid,          start.source,   start.temperature, prepared.bodies};
}

void advance(FluidSolver& liquid, double time, const LiquidWatch& watch) {
  while (time - liquid.time() > kTimeTolerance) watch(liquid.step(time - liquid.time()));
}

PowerLaw fit_power_law(std::span<const Vec2> points) {
  const double n = static_cast<double>(points.size());
  Vec2 mean = Vec2::Zero();
  for (const Vec2& p : points) mean += p.array().log().matrix() / n;
  double xx = 0, xy = 0;
  for (const Vec2& p : points) {
    const Vec2 d = p.array().log().matrix() - mean;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
  }
  const double exponent = xy / xx;
  return {exponent, std::exp(mean.y() - exponent * mean.x())};
}

double rms_difference(std::span<const Vec2> points, const std::function<double(double)>& reference) {
  double sum = 0;
  for (const Vec2& p : points) sum += std::pow(p.y() - reference(p.x()), 2);
  return std::sqrt(sum / static_cast<double>(points.size()));
}

std::vector<Vec2> sampled(const std::function<double(double)>& reference, double first, double last,
                          int count) {
  std::vector<Vec2> points;
  for (int k = 0; k < count; ++k) {
    const double x = first + (last - first) * k / (count - 1);
    points.emplace_back(x, reference(x));
  }
  return points;
}

std::string csv_text(const std::string& header, const std::vector<std::vector<double>>& rows) {
  std::string text = header + "\n";
  for (const std::vector<double>& row : rows)
    for (std::size_t k = 0; k < row.size(); ++k)
      text += fmt::format("{:.6g}{}", row[k], k + 1 < row.size() ? ',' : '\n');
  return text;
}

}  // namespace kappaflow
