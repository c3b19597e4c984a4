#include "tools/experiments/enright_body.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "surface/field/particle_weights.h"
#include "surface/remesh/initial_mesh.h"
#include "tools/experiments/enright_flow.h"
#include "tools/experiments/fibonacci_sphere.h"

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
      project(EnrightField(time_), x, {.tolerance = 1e-6, .reach = 10, .iterations = 15});
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

namespace {

constexpr int kSpherePoints = 4000;  // over which the field is averaged

}  // namespace

EnrightParticles::EnrightParticles(double spacing) {
  int shell = 0;
  for (double r = EnrightFlow::kRadius - 0.5 * spacing; r > 0.3 * spacing; r -= spacing, ++shell) {
    const int count =
        std::max(1, static_cast<int>(std::lround(4 * std::numbers::pi * r * r / (spacing * spacing))));
    // Shells are turned against each other, so that their poles, where the lattice is least even, do not line
    // up.
    for (const Vec3& d : fibonacci_sphere(count, Vec3(1, 2, 3), 1.1 * shell)) {
      particles_.id.push_back(static_cast<std::int64_t>(particles_.id.size()));
      particles_.position.emplace_back(kCentre + r * d);
    }
  }
  particles_.velocity.resize(particles_.id.size());
  at(0);
}

double EnrightParticles::threshold(ParticleFieldOptions options) const {
  const std::vector<double> weights = field_weights(particles_.position, options.sigma, options.weights);
  options.threshold = half_median_threshold(particles_.position, weights, options.sigma);
  const auto field = particle_field(particles_, options);
  const std::vector<Vec3> sphere = fibonacci_sphere(kSpherePoints, Vec3(1, 0, 0), 0);
  return options.threshold + parallel_sum(sphere.size(), 0.0, [&](std::size_t i) {
                               return field->value_and_gradient(kCentre + EnrightFlow::kRadius * sphere[i]).f;
                             }) / kSpherePoints;
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
