// Tracks the surface of a turning body by a velocity method of this program's own, with an array of its own.
#include <kappaflow/core/errors.h>
#include <kappaflow/surface/tracker/tracked_surfaces.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "height.h"

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

int main() try {
  const bool heights = heights_stay(), temperatures = temperatures_stay();
  return heights && temperatures ? 0 : 1;
} catch (const Error& error) {
  std::fprintf(stderr, "height: error: %s\n", error.what());
  return error.exit_code();
}
