// One remeshing at work: what its passes share. Private to this folder.
#pragma once

#include <vector>

#include "surface/mesh/mesh_edits.h"
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
  std::vector<Projected> midpoints;
  std::vector<double> size, smoothed;
  std::vector<char> flag;
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
/// Returns whether an edit was made.
bool repair_sharp_triangles(const RemeshSetting& setting, RemeshState& state);

/// Joins the ends of h at one of them if that may be; repair: for the sake of a sharp triangle, whose
/// surroundings must not become worse; else they must not become bad.
bool collapse_either_way(const RemeshSetting& setting, int h, bool repair, RemeshState& state);

}  // namespace kappaflow
