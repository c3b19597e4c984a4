#include "tools/experiments/enright_body.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "surface/field/enright_flow.h"
#include "surface/tracker/initial_mesh.h"

namespace kappaflow {
namespace {

const Vec3 kCentre(EnrightFlow::kCentre[0], EnrightFlow::kCentre[1], EnrightFlow::kCentre[2]);

/// Mean and largest of distance(i).
template <class Distance>
VertexError mean_and_max(std::size_t n, const Distance& distance) {
  std::vector<double> d(n);
  parallel_for(n, [&](std::size_t i) { d[i] = distance(i); });
  return {parallel_sum(n, 0.0, [&](std::size_t i) { return d[i]; }) / static_cast<double>(n),
          parallel_max(n, 0.0, [&](std::size_t i) { return d[i]; })};
}

}  // namespace

EnrightShape::EnrightShape(double time, double resolution) : time_(time) {
  reference_ = initial_mesh(EnrightField(0), resolution, {.tolerance = 1e-8});
  carry<EnrightFlow>(reference_.position, 0, time);
  solid_ = std::make_unique<SolidDistance>(TriangleSurface{reference_.position, reference_.triangles});
}

// Both are distances to points on or near the shape; the nearer one counts. The reference mesh is coarse
// where the flow has drawn it out, and the projection may miss the nearest point or fail.
double EnrightShape::distance(const Vec3& x) const {
  const double to_reference = std::abs(solid_->nearest(x).distance);
  const Projected projected =
      project(EnrightField(time_), x, {.tolerance = 1e-6, .reach = 10, .iterations = 50});
  return projected.converged ? std::min(to_reference, (projected.position - x).norm()) : to_reference;
}

ShapeError EnrightShape::error(const TriangleMesh& mesh) const {
  const VertexError vertices =
      mean_and_max(mesh.vertex_count(), [&](std::size_t v) { return distance(mesh.position[v]); });
  const VertexError triangles = mean_and_max(mesh.triangles.size(), [&](std::size_t t) {
    const auto& [a, b, c] = mesh.triangles[t];
    return distance((mesh.position[a] + mesh.position[b] + mesh.position[c]) / 3);
  });
  const SolidDistance tracked(TriangleSurface{mesh.position, mesh.triangles});
  const VertexError shape = mean_and_max(reference_.vertex_count(), [&](std::size_t v) {
    return std::abs(tracked.nearest(reference_.position[v]).distance);
  });
  return {vertices.mean, vertices.max, triangles.mean, triangles.max, shape.mean, shape.max};
}

VertexError vertex_error(const TriangleMesh& mesh, double time) {
  std::vector<Vec3> material = mesh.rest_position;
  carry<EnrightFlow>(material, 0, time);
  return mean_and_max(mesh.vertex_count(),
                      [&](std::size_t v) { return (mesh.position[v] - material[v]).norm(); });
}

EnrightParticles::EnrightParticles(double spacing) {
  const int half = static_cast<int>(std::ceil(EnrightFlow::kRadius / spacing));
  for (int k = -half; k <= half; ++k)
    for (int j = -half; j <= half; ++j)
      for (int i = -half; i <= half; ++i) {
        const Vec3 d = spacing * Vec3(i, j, k);
        // Half a spacing off the sphere: the surface of Eq. 12 lies about that far outside the particles.
        if (d.norm() > EnrightFlow::kRadius - 0.5 * spacing) continue;
        particles_.id.push_back(static_cast<std::int64_t>(particles_.id.size()));
        particles_.position.emplace_back(kCentre + d);
      }
  particles_.velocity.resize(particles_.id.size());
  at(0);
}

const Particles& EnrightParticles::at(double time) {
  carry<EnrightFlow>(particles_.position, particles_.time, time);
  particles_.time = time;
  parallel_for(particles_.size(), [&](std::size_t i) {
    particles_.velocity[i] = flow_velocity<EnrightFlow>(particles_.position[i], time);
  });
  return particles_;
}

}  // namespace kappaflow
