// How triangles are evened out between the steps of a tracker.
#pragma once

#include "core/named.h"

namespace kappaflow {

/// Which vertices fairing moves: all, as in the paper, or each only as far as its velocity is undetermined
/// (the paper's future work): a confident vertex is a constraint, an unconfident one follows its neighbours.
enum class FairedVertices { undetermined, all };

/// What scenes call them.
inline constexpr Named<FairedVertices> kFairedVertices[] = {{"undetermined", FairedVertices::undetermined},
                                                            {"all", FairedVertices::all}};

struct FairingOptions {
  int iterations = 10;      ///< relaxations a step; 0 switches fairing off
  double relaxation = 0.5;  ///< share of the way to the springs' equilibrium an iteration goes, (0, 1]
  FairedVertices moves = FairedVertices::undetermined;
  double rest_length_time = 0.5;  ///< rest lengths follow the current lengths with this time constant [s]
};

}  // namespace kappaflow
