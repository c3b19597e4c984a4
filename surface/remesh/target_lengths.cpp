// The edge lengths that a remeshing aims at.
#include <algorithm>

#include "core/parallel.h"
#include "surface/remesh/remesh_state.h"

namespace kappaflow {
namespace {

constexpr double kGrading = 0.4;   // largest change of the length aimed at per length along the surface
constexpr int kGradingPasses = 3;  // more follow in the next steps

/// Normal curvature of the surface along edge (u, v), torsion included [1/m]; 0 where an end is off it.
double normal_turn(const RemeshState& state, int u, int v) {
  const std::vector<char>& unprojected = state.edits.mesh().unprojected;
  if (unprojected[u] || unprojected[v]) return 0;
  return (state.normal[v] - state.normal[u]).norm() / (state.at(v) - state.at(u)).norm();
}

}  // namespace

void set_target_lengths(const RemeshSetting& setting, const VertexRings& rings, RemeshState& state) {
  const RemeshOptions& options = setting.options;
  const TriangleMesh& mesh = state.edits.mesh();
  const std::size_t n = mesh.vertex_count();
  state.normal.resize(n);
  state.target.resize(n);
  state.smoothed.resize(n);
  parallel_for(n, [&](std::size_t v) { state.normal[v] = -mesh.gradient[v].normalized(); });
  parallel_for(n, [&](std::size_t i) {
    const int v = static_cast<int>(i);
    double curvature = 0;
    for (const int w : rings.of(v)) curvature = std::max(curvature, normal_turn(state, v, w));
    state.target[v] =
        std::clamp(options.turn / curvature, options.finest * options.edge_length, options.edge_length);
  });
  for (int pass = 0; pass < kGradingPasses; ++pass) {
    parallel_for(n, [&](std::size_t i) {
      const int v = static_cast<int>(i);
      double target = state.target[v];
      for (const int w : rings.of(v))
        target = std::min(target, state.target[w] + kGrading * (state.at(w) - state.at(v)).norm());
      state.smoothed[v] = target;
    });
    std::swap(state.target, state.smoothed);
  }
}

}  // namespace kappaflow
