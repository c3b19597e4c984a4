// A subset of a mesh's vertices that is spread evenly over it: what a neighbourhood is made of where the mesh
// is finer than needed.
#pragma once

#include <span>
#include <vector>

#include "core/connectivity.h"

namespace kappaflow {

/// Samples and the patches of the mesh around them: every vertex belongs to the patch of one sample, the
/// nearest that reached it along the mesh. Arrays have one entry a sample unless stated.
struct SurfaceSamples {
  std::vector<int> vertex;        ///< the sample's vertex, ascending
  std::vector<int> of_vertex;     ///< one entry a vertex: the sample to whose patch it belongs
  std::vector<Vec3> position;     ///< [m]
  std::vector<int> patch_start;   ///< samples + 1 entries
  std::vector<int> patch_vertex;  ///< the patch of sample s: entries patch_start[s] to patch_start[s + 1]
  VertexRings rings;              ///< samples whose patches share an edge of the mesh

  std::span<const int> patch(std::size_t s) const {
    return {patch_vertex.data() + patch_start[s],
            static_cast<std::size_t>(patch_start[s + 1] - patch_start[s])};
  }
};

/// Vertices taken in turn: one that no sample has reached yet becomes a sample and reaches all vertices that
/// are connected to it within the ball of its spacing[v] [m]. No two samples are closer along the mesh than
/// the spacing of the first; a mesh coarser than the spacing is its own sample. spacing: one entry a vertex.
SurfaceSamples surface_samples(std::span<const Vec3> position, const VertexRings& rings,
                               std::span<const double> spacing);

/// Walks over samples; keeps its scratch, so that walks allocate nothing. One a thread.
class SampleWalk {
 public:
  /// The samples within `radius` [m] of x that are connected to `start`, itself included, by a path of
  /// samples within that ball not longer than 1.5 radius; in the order of the walk, valid until the next
  /// call. What only a gap or a thin film separates from x is not among them.
  std::span<const int> around(const SurfaceSamples& samples, const Vec3& x, int start, double radius);

 private:
  std::vector<int> found_;
  std::vector<double> path_;         // length of the path to each of found_ [m]
  std::vector<std::uint32_t> mark_;  // of each sample: the walk that found it last
  std::uint32_t walk_ = 0;
};

}  // namespace kappaflow
