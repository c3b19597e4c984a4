// Lets the mesh merge, split, appear and vanish as the surface does.
#pragma once

#include <span>
#include <vector>

#include "surface/field/field.h"
#include "surface/field/projection.h"
#include "surface/mesh/mesh_edits.h"
#include "surface/topology/cell_region.h"
#include "surface/topology/lattice_guard.h"
#include "surface/topology/topology_options.h"

namespace kappaflow {

/// The lattice that tells the surface's topology; without values. edge_length: of the mesh, > 0 [m].
SampledField topology_lattice(const Field& field, const TopologyOptions& options, double edge_length);

/// What on that lattice keeps the mesh's topology the surface's while the mesh is edited.
LatticeGuard topology_guard(const Field& field, const TopologyOptions& options, double edge_length);

/// By what a change of topology looks for disagreement.
enum class Comparison {
  quick,     ///< triangles further off the surface than half an edge
  thorough,  ///< those further than 0.18 edges, triangles that pass through others, the whole lattice
  repeated   ///< the same after another, and only where something has changed since or was left as it was;
             ///< patches whose chords miss a rim or tip are made finer
};

/// Local replacement of the mesh by the isosurface, after Wojtan, Thuerey, Gross, Turk, "Deforming meshes
/// that split and merge" (2009) and Mueller, "Fast and robust tracking of fluid surfaces" (2009), guided by
/// the field: it knows the true surface at every step.
///
/// Where mesh and f = 0 disagree (see disagreement.h; or the mesh passes through itself) the triangles
/// around are taken out, f = 0 is extracted there, what of it is nearer to the triangles left than a
/// quarter of an edge is cut away, and what is left between the loops of both sides is filled. The result is
/// taken if every new triangle is a piece of f = 0 (is_off_surface()), passes through no other, and has three
/// neighbours; else the region is widened where it was not, some times, and then counted as refused.
///
/// Vertices outside keep place, id and what arrays hold of them; new ones have new ids and come, by the
/// arrays' rules, from the nearest point of the triangles taken out, or from nowhere where there were none.
/// Regions that do not touch each other are worked on at once: results do not depend on the threads.
class TopologyChange {
 public:
  /// edge_length: of the mesh, > 0 [m]. mesh: its vertices projected, TriangleMesh::gradient theirs. Where
  /// TopologyCounts::replaced > 0, whoever keeps more about the vertices renews it (see history()). touched,
  /// for a repeated comparison: of each vertex, whether triangles of it have changed since the last
  /// comparison, and nothing has moved; empty: anything may have. Throws TopologyError for a mesh that is not
  /// closed, with no change.
  TopologyCounts change(const Field& field, const TopologyOptions& options, double edge_length,
                        const ProjectionOptions& projection, Comparison comparison, TriangleMesh& mesh,
                        std::span<const char> touched = {});

  /// What became of the vertices in the last change().
  const VertexHistory& history() const { return edits_.history(); }

 private:
  MeshEdits edits_;
  std::vector<LatticeCell> unsettled_;  // where the last change left something as it was, in coarse cells
};

}  // namespace kappaflow
