#include "surface/mesh/surface_samples.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace kappaflow {
namespace {

constexpr double kLongestPath = 1.5;  // [radii] along the mesh: what is further is the other side of a film

/// Gives the patch of each new sample the vertices that it is nearest to so far.
void choose_samples(std::span<const Vec3> position, const VertexRings& rings, std::span<const double> spacing,
                    SurfaceSamples& samples) {
  std::vector<double> distance2(position.size(), std::numeric_limits<double>::infinity());
  std::vector<int> queue;
  samples.of_vertex.assign(position.size(), -1);
  for (int v = 0; v < static_cast<int>(position.size()); ++v) {
    if (samples.of_vertex[v] >= 0) continue;
    const int sample = static_cast<int>(samples.vertex.size());
    samples.vertex.push_back(v);
    samples.of_vertex[v] = sample;
    distance2[v] = 0;
    queue.assign(1, v);
    for (std::size_t head = 0; head < queue.size(); ++head)
      for (const int w : rings.of(queue[head])) {
        const double d2 = (position[w] - position[v]).squaredNorm();
        if (!(d2 < std::min(distance2[w], spacing[v] * spacing[v]))) continue;
        distance2[w] = d2;
        samples.of_vertex[w] = sample;
        queue.push_back(w);
      }
  }
}

void set_patches(SurfaceSamples& samples) {
  samples.patch_start.assign(samples.vertex.size() + 1, 0);
  samples.patch_vertex.resize(samples.of_vertex.size());
  for (const int s : samples.of_vertex) ++samples.patch_start[s + 1];
  std::partial_sum(samples.patch_start.begin(), samples.patch_start.end(), samples.patch_start.begin());
  std::vector<int> end(samples.patch_start.begin(), samples.patch_start.end() - 1);
  for (int v = 0; v < static_cast<int>(samples.of_vertex.size()); ++v)
    samples.patch_vertex[end[samples.of_vertex[v]]++] = v;
}

VertexRings sample_rings(const SurfaceSamples& samples, const VertexRings& rings) {
  VertexRings result{.start = {0}, .neighbour = {}};
  for (int s = 0; s < static_cast<int>(samples.vertex.size()); ++s) {
    const auto first = static_cast<std::ptrdiff_t>(result.neighbour.size());
    for (const int v : samples.patch(s))
      for (const int w : rings.of(v))
        if (samples.of_vertex[w] != s) result.neighbour.push_back(samples.of_vertex[w]);
    std::sort(result.neighbour.begin() + first, result.neighbour.end());
    result.neighbour.erase(std::unique(result.neighbour.begin() + first, result.neighbour.end()),
                           result.neighbour.end());
    result.start.push_back(static_cast<int>(result.neighbour.size()));
  }
  return result;
}

}  // namespace

SurfaceSamples surface_samples(std::span<const Vec3> position, const VertexRings& rings,
                               std::span<const double> spacing) {
  SurfaceSamples samples;
  choose_samples(position, rings, spacing, samples);
  for (const int v : samples.vertex) samples.position.push_back(position[v]);
  set_patches(samples);
  samples.rings = sample_rings(samples, rings);
  return samples;
}

std::span<const int> SampleWalk::around(const SurfaceSamples& samples, const Vec3& x, int start,
                                        double radius) {
  if (mark_.size() != samples.vertex.size() || ++walk_ == 0) {
    mark_.assign(samples.vertex.size(), 0);
    walk_ = 1;
  }
  found_.assign(1, start);
  path_.assign(1, (samples.position[start] - x).norm());
  mark_[start] = walk_;
  for (std::size_t head = 0; head < found_.size(); ++head) {
    const Vec3& from = samples.position[found_[head]];
    for (const int s : samples.rings.of(found_[head])) {
      if (mark_[s] == walk_) continue;
      if (!((samples.position[s] - x).squaredNorm() < radius * radius)) {
        mark_[s] = walk_;
        continue;
      }
      const double path = path_[head] + (samples.position[s] - from).norm();
      if (path > kLongestPath * radius) continue;
      mark_[s] = walk_;
      found_.push_back(s);
      path_.push_back(path);
    }
  }
  return found_;
}

}  // namespace kappaflow
