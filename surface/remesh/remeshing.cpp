#include "surface/remesh/remeshing.h"

#include "surface/remesh/remesh_state.h"

namespace kappaflow {
namespace {

constexpr int kRepairRounds = 3;  // of flips and repairs; most meshes are in order after one

}  // namespace

Remesher::Remesher() : state_(std::make_unique<RemeshState>()) {}
Remesher::~Remesher() = default;
Remesher::Remesher(Remesher&&) noexcept = default;
Remesher& Remesher::operator=(Remesher&&) noexcept = default;

const VertexHistory& Remesher::history() const {
  return state_->edits.history();
}

RemeshCounts Remesher::remesh(const Field& field, const RemeshOptions& options,
                              const ProjectionOptions& projection, const VertexRings& rings,
                              TriangleMesh& mesh, const EditGuard* guard) {
  const RemeshSetting setting{field, options, projection};
  RemeshState& state = *state_;
  state.counts = {};
  state.edits.start(mesh, guard);
  set_target_lengths(setting, rings, state);
  split_long_edges(setting, state);
  refine_off_surface(setting, state);
  collapse_short_edges(setting, state);
  for (int round = 0; round < kRepairRounds; ++round) {
    flip_towards_delaunay(setting, state);
    if (!repair_sharp_triangles(setting, round > 0, state)) break;
  }
  state.edits.finish();
  return state.counts;
}

void RemeshState::add_born(int v, const Projected& projected, const VertexBlend& from) {
  edits.set_gradient(v, projected.gradient);
  normal.emplace_back(-projected.gradient.normalized());
  target.push_back(blended(target, from));
  counts.residual_max = std::max(counts.residual_max, projected.residual);
}

}  // namespace kappaflow
