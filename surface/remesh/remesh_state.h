// One remeshing at work: what its passes share. Private to this folder.
#pragma once

#include <vector>

#include "surface/mesh/mesh_edits.h"
#include "surface/remesh/edits_ahead.h"
#include "surface/remesh/remeshing.h"

namespace kappaflow {

/// What a remeshing is asked for.
struct RemeshSetting {
  const Field& field;
  const RemeshOptions& options;
  const ProjectionOptions& projection;
};

/// The mesh in the making, between edits.start() and edits.finish(), and what is known of its vertices.
struct RemeshState {
  MeshEdits edits;
  std::vector<double> target;  ///< edge length aimed at, at each vertex [m]
  std::vector<Vec3> normal;    ///< outward unit normal of the field at each vertex
  RemeshCounts counts;

  // Memory that is used again from step to step.
  struct Candidate {
    double size;  ///< length over the length aimed at
    int u, v;
  };
  std::vector<Candidate> candidates;
  std::vector<std::vector<Candidate>> parts;
  std::vector<Projected> midpoints;
  std::vector<double> smoothed;
  std::vector<char> flag;
  std::vector<std::uint32_t> unrepaired;  ///< of each triangle: after how many edits no repair was found
  std::vector<int> pending, suspects;

  const Vec3& at(int v) const { return edits.at(v); }
  double aimed_at(int u, int v) const { return 0.5 * (target[u] + target[v]); }

  /// Enters what is known of a vertex that an edit has made.
  void add_born(int v, const Projected& projected, const VertexBlend& from);
};

// The passes, in the order in which Remesher::remesh() makes them; docs/remeshing.md describes them.

/// target: clamp(turn / kappa, finest edge_length, edge_length), smoothed so that it changes by at most 0.4
/// of the way along the surface; kappa: the largest normal curvature along an edge.
void set_target_lengths(const RemeshSetting& setting, const VertexRings& rings, RemeshState& state);
void split_long_edges(const RemeshSetting& setting, RemeshState& state);
void refine_off_surface(const RemeshSetting& setting, RemeshState& state);
void collapse_short_edges(const RemeshSetting& setting, RemeshState& state);
void flip_towards_delaunay(const RemeshSetting& setting, RemeshState& state);
/// again: nothing but flips came since the last call. Returns whether an edit was made.
bool repair_sharp_triangles(const RemeshSetting& setting, bool again, RemeshState& state);

/// A collapse that may be: of this half-edge; -1: of none.
struct Collapse {
  Grounds grounds;
  int half_edge = -1;
};

/// Whether the ends of h may be joined at one of them; repair: for the sake of a sharp triangle, whose
/// surroundings must not become worse; else they must not become bad.
Collapse find_collapse(const RemeshSetting& setting, const RemeshState& state, int h, bool repair);
/// Returns whether there was one to be made.
bool make_collapse(const Collapse& collapse, RemeshState& state);

}  // namespace kappaflow
