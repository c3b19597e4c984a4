#include "surface/measure/traced_texture.h"

#include "surface/mesh/nearest_on_mesh.h"

namespace kappaflow {
namespace {

/// Over sigma; distance(i) of the tracers for which counts(i).
std::optional<double> mean_distance(std::size_t n, double sigma, const auto& counts, const auto& distance) {
  const Vec2 sum = parallel_sum(n, Vec2(Vec2::Zero()), [&](std::size_t i) -> Vec2 {
    return counts(i) ? Vec2(distance(i), 1) : Vec2(Vec2::Zero());
  });
  if (sum[1] == 0) return std::nullopt;
  return sum[0] / (sum[1] * sigma);
}

}  // namespace

TracedTexture traced_texture(const TriangleMesh& mesh, const MaterialTracers& tracers, double sigma) {
  const std::size_t n = tracers.position().size();
  TracedTexture texture{std::vector<Vec3>(n, Vec3::Zero()), std::vector<char>(n, 0)};
  const NearestOnMesh surface(mesh);
  parallel_for(n, [&](std::size_t i) {
    if (tracers.lost()[i]) return;
    const auto point = surface.nearest(tracers.position()[i]);
    if (!point || point->distance > kAtSurface * sigma) return;
    texture.rest[i] = blended(mesh.rest_position, point->blend);
    texture.known[i] = 1;
  });
  return texture;
}

std::optional<double> texture_distance(const TracedTexture& texture, const MaterialTracers& tracers,
                                       double sigma) {
  return mean_distance(
      texture.rest.size(), sigma, [&](std::size_t i) { return texture.known[i]; },
      [&](std::size_t i) { return (texture.rest[i] - tracers.start()[i]).norm(); });
}

std::optional<double> texture_flicker(const TracedTexture& before, const TracedTexture& now, double sigma) {
  return mean_distance(
      std::min(before.rest.size(), now.rest.size()), sigma,
      [&](std::size_t i) { return before.known[i] && now.known[i]; },
      [&](std::size_t i) { return (now.rest[i] - before.rest[i]).norm(); });
}

}  // namespace kappaflow
