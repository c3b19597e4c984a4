// The experiments on bodies in rigid motion: Figs. 3 to 8 of Fujisawa, Mandachi & Miura (2011), and a body
// that has features everywhere.
#pragma once

#include "tools/experiments/experiment.h"

namespace kappaflow {

Report experiment_fig3(const ExperimentContext& context);  ///< triangles under a translation
Report experiment_fig4(const ExperimentContext& context);  ///< three particles, three turns, with fairing
Report experiment_fig5(const ExperimentContext& context);  ///< their error against the fairing iterations
Report experiment_fig7(const ExperimentContext& context);  ///< one particle, thirty turns: the meshes
Report experiment_fig8(const ExperimentContext& context);  ///< the error turn by turn, for each integrator
Report experiment_body(const ExperimentContext& context);  ///< seven unequal particles, ten turns

}  // namespace kappaflow
