// What the validations of liquid that coils and of liquid that folds have in common: each runs in regimes in
// which other forces balance its bending, and at several spacings.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <span>
#include <type_traits>
#include <vector>

#include "scenes/scene.h"
#include "tools/experiments/experiment.h"
#include "tools/experiments/validation.h"

namespace kappaflow {

/// What is balanced against bending: the liquid of the scene with other numbers.
struct FallingRegime {
  const char* name;
  double viscosity, gravity;  ///< kinematic [m2/s], [m/s2]
  double from, duration;      ///< watched from, and until [s]
};

/// The scene with the regime's liquid.
inline Scene in_regime(Scene scene, const FallingRegime& regime) {
  scene.fluid.kinematic_viscosity = regime.viscosity;
  scene.fluid.gravity = Vec3(0, -regime.gravity, 0);
  return scene;
}

/// run(scene, regime) in each regime at each spacing, given over the scene's; the last regime only where the
/// experiment is quick.
template <class Run>
auto run_regimes(const ExperimentContext& context, const Scene& scene, std::span<const FallingRegime> regimes,
                 std::span<const double> spacings, const Run& run) {
  std::vector<std::invoke_result_t<Run, Scene, const FallingRegime&>> results;
  for (const FallingRegime& regime : context.options.quick ? regimes.last(1) : regimes)
    for (const double spacing : spacings) {
      const Scene refined = with_spacing(scene, spacing * scene.fluid.spacing);
      context.say(fmt::format("{}, spacing {:.3g} m", regime.name, refined.fluid.spacing));
      results.push_back(run(in_regime(refined, regime), regime));
    }
  return results;
}

inline const Claim kConverges{"kappaflow", "The frequency does not depend on the spacing.",
                              "Relative difference between the two finest spacings."};
inline constexpr double kSpacingLimit = 0.1;  ///< of that, relative

/// From each spacing to the next finer one of the same regime. Result has regime, a pointer, and frequency.
template <class Result>
std::vector<Check> spacing_checks(const std::vector<Result>& results) {
  std::vector<Check> checks;
  for (std::size_t k = 1; k < results.size(); ++k)
    if (results[k - 1].regime == results[k].regime)
      checks.push_back(at_most(results[k].regime->name,
                               std::abs(results[k].frequency / results[k - 1].frequency - 1), kSpacingLimit));
  return checks;
}

}  // namespace kappaflow
