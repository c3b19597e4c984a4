// Tracks the surface of a turning body by a velocity method of this program's own, with an array of its own;
// the surface of a field of its own, and one that is known as images of its distance.
#include <kappaflow/core/errors.h>
#include <kappaflow/surface/mesh/mesh_measures.h>
#include <kappaflow/surface/motion/normal.h>
#include <kappaflow/surface/motion/regional.h>
#include <kappaflow/surface/motion/velocity_methods.h>
#include <kappaflow/surface/remesh/initial_mesh.h>
#include <kappaflow/surface/tracker/surface_group.h>
#include <kappaflow/surface/tracker/surface_tracker.h>
#include <kappaflow/surface/tracker/tracked_surfaces.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "height.h"
#include "image.h"
#include "ovals.h"

using namespace kappaflow;

/// Eight particles at the corners of a box, which turns about the y axis with 1/s.
Particles turning_box(double time) {
  Particles box;
  box.time = time;
  const Eigen::AngleAxisd rotation(time, Vec3::UnitY());
  for (int k = 0; k < 8; ++k) {
    box.id.push_back(k);
    box.position.push_back(rotation * Vec3(k & 1 ? 0.2 : -0.2, k & 2 ? 0.3 : -0.3, k & 4 ? 0.1 : -0.1));
    box.velocity.push_back(Vec3::UnitY().cross(box.position.back()));
  }
  return box;
}

/// The options of both surfaces.
SurfaceOptions options_for_the_box() {
  SurfaceOptions options;
  options.sigma = 0.8, options.spacing = 1, options.threshold = 0.5;  // [m]
  options.edge_length = 0.25;
  options.velocities = {evaluate_height};
  options.tracker.velocity = {.damping = 1e-3, .speed_limit = 4};
  return options;
}

/// Whether points keep their height while they move.
bool heights_stay() {
  SurfaceOptions options = options_for_the_box();
  options.remesh = false, options.tracker.fairing.iterations = 0;  // nothing but the method moves vertices
  TrackedSurfaces surface(turning_box(0), options);
  std::ptrdiff_t lost = 0;  // vertices that are not on the surface, over all frames
  for (int frame = 1; frame <= 10; ++frame) {
    surface.advance(turning_box(0.02 * frame));
    lost += std::ranges::count(surface.mesh().unprojected, 1);
  }

  double moved = 0, height_change = 0;
  const TriangleMesh& mesh = surface.mesh();
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    moved = std::max(moved, (mesh.position[v] - mesh.rest_position[v]).norm());
    height_change = std::max(height_change, std::abs(mesh.position[v].y() - mesh.rest_position[v].y()));
  }
  std::printf("%zu vertices moved by up to %.12g m and changed their height by %.17g m\n",
              mesh.vertex_count(), moved, height_change);
  return lost == 0 && moved > 0.02 && height_change < 0.01 * moved;
}

/// Whether an array that is a function of rest_position stays it while the mesh is edited: both are
/// interpolated.
bool temperatures_stay() {
  TrackedSurfaces warm(turning_box(0), options_for_the_box());
  warm.add_array<double>("temperature", Carry::interpolate, 20);
  const TriangleMesh& mesh = warm.mesh();
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    warm.array<double>("temperature")[v] = 20 + 10 * mesh.rest_position[v].y();
  const std::int64_t first_born = mesh.next_id;
  for (int frame = 1; frame <= 100; ++frame) warm.advance(turning_box(0.05 * frame));

  double error = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    error =
        std::max(error, std::abs(warm.array<double>("temperature")[v] - 20 - 10 * mesh.rest_position[v].y()));
  const std::size_t born = mesh.vertex_count() - vertices_older_than(mesh, first_born);
  std::printf("%zu of %zu vertices are new\n", born, mesh.vertex_count());
  return born > 0 && error < 1e-12;
}

/// Volume of the ovals: pi times the integral of y^2 = sqrt(4 c^2 x^2 + 1) - x^2 - c^2 over where that is
/// positive.
double volume_of_ovals(double c) {
  constexpr int kPoints = 100000;
  const double end = std::sqrt(1 + c * c);
  double sum = 0;
  for (int k = 0; k < kPoints; ++k) {
    const double x = end * (k + 0.5) / kPoints;
    sum += std::max(0.0, std::sqrt(4 * c * c * x * x + 1) - x * x - c * c);
  }
  return 2 * 3.14159265358979 * end / kPoints * sum;
}

/// Whether a method follows the surface of a field that particles do not define, also where it splits.
bool ovals_split(const char* method) {
  constexpr double kEdgeLength = 0.05, kStep = 0.01;  // [m], [s]
  constexpr int kSteps = 40;
  TrackerOptions options;
  options.method = velocity_method(method).evaluate;
  options.remeshing.edge_length = kEdgeLength;
  options.topology.follows_field = true;
  const Ovals first(0), last(kSteps * kStep);
  SurfaceTracker tracker(
      SurfaceTracker::settled(first, initial_mesh(first, kEdgeLength, options.projection), options), options);
  const auto pieces = [&] {
    return mesh_topology(tracker.mesh().position, tracker.mesh().triangles).components;
  };
  const int pieces_before = pieces();
  for (int n = 0; n < kSteps; ++n) {
    MovingOvals motion(n * kStep, (n + 1) * kStep);
    tracker.step(motion);
  }
  tracker.settle(last);
  const TriangleMesh& mesh = tracker.mesh();
  const double volume = area_and_volume(mesh.position, mesh.triangles).volume;
  const double exact = volume_of_ovals(Ovals::kFirst + Ovals::kSpeed * last.time());
  std::printf("ovals by %s: pieces %d, %d; volume %.2f m3 of %.2f m3\n", method, pieces_before, pieces(),
              volume, exact);
  return pieces_before == 1 && pieces() == 2 && std::ranges::count(mesh.unprojected, 1) == 0 &&
         std::abs(volume / exact - 1) < 0.01;
}

/// Whether vertices turn with a body that is known by its distance alone.
bool images_are_followed() {
  constexpr double kInterval = 0.05;  // between images [s]
  constexpr int kFrames = 11;
  SurfaceOptions options;
  options.velocities = {evaluate_regional, evaluate_normal};
  options.edge_length = 0.25;
  DistanceMotion beginning(image_of_box(0), image_of_box(kInterval));
  FieldSurfaces surfaces(beginning.at(0), options);
  for (int frame = 1; frame < kFrames; ++frame) {
    const double t = frame * kInterval;
    DistanceMotion motion(image_of_box(t - kInterval), image_of_box(t), image_of_box(t - 2 * kInterval),
                          image_of_box(t + kInterval));
    surfaces.step(motion);
    surfaces.settle();
  }

  const Eigen::AngleAxisd turn((kFrames - 1) * kInterval, Vec3::UnitZ());
  const auto mean_error = [&](const TriangleMesh& mesh) {
    double sum = 0;
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
      sum += (mesh.position[v] - turn * mesh.rest_position[v]).norm();
    return sum / static_cast<double>(mesh.vertex_count());
  };
  const double regional = mean_error(surfaces.mesh(0)), normal = mean_error(surfaces.mesh(1));
  std::printf("a box as images: %.4f m from its material by regional, %.4f m by normal\n", regional, normal);
  return regional < 0.5 * normal;
}

int main() try {
  const bool heights = heights_stay(), temperatures = temperatures_stay(),
             split = ovals_split("total") && ovals_split("curvature") && ovals_split("regional"),
             followed = images_are_followed();
  return heights && temperatures && split && followed ? 0 : 1;
} catch (const Error& error) {
  std::fprintf(stderr, "height: error: %s\n", error.what());
  return error.exit_code();
}
