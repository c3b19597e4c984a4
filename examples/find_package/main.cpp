// Tracks the surface of a ball of particles that rolls, and says how far its vertices end up from their
// material.
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>

#include "core/errors.h"
#include "surface/field/particle_motion.h"
#include "surface/field/rigid_particles.h"
#include "surface/remesh/initial_mesh.h"
#include "surface/tracker/surface_tracker.h"

namespace {

using namespace kappaflow;

constexpr double kSpacing = 0.1, kSigma = 2 * kSpacing;  // [m]
constexpr int kSteps = 10;                               // a frame of the simulation each
constexpr double kFrameTime = 0.02;                      // [s]
const SteadyMotion kRolling{.velocity = Vec3(1.2, 0, 0), .angular_velocity = Vec3(0, 0, -3)};

/// The particles as a simulation would hand them over: ids, positions and velocities at one instant.
Particles particles_at(double time) {
  Particles ball;
  ball.time = time;
  for (int k = 0; k < 9 * 9 * 9; ++k) {
    const Vec3 x0 = kSpacing * Vec3(k % 9 - 4, k / 9 % 9 - 4, k / 81 - 4);
    if (x0.norm() > 0.4) continue;
    ball.id.push_back(k);
    ball.position.push_back(kRolling.position(x0, time));
    ball.velocity.push_back(kRolling.velocity +
                            kRolling.angular_velocity.cross(kRolling.rotation(time) * x0));
  }
  return ball;
}

double largest_error(const TriangleMesh& mesh, double time) {
  double largest = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    largest = std::max(largest, (mesh.position[v] - kRolling.position(mesh.rest_position[v], time)).norm());
  return largest / kSigma;
}

void roll() {
  const ParticleFieldOptions field{.sigma = kSigma, .threshold = 2};
  Particles now = particles_at(0);
  SurfaceTracker tracker(initial_mesh(*particle_field(now, field), 0.5 * kSigma, {}),
                         {.method = evaluate_regional});
  for (int frame = 1; frame <= kSteps; ++frame) {
    const Particles next = particles_at(frame * kFrameTime);
    ParticleMotion motion(now, next, field);
    tracker.step(motion);
    now = next;
  }
  std::printf("%zu vertices, at most %.3f sigma from their material after %g s\n",
              tracker.mesh().vertex_count(), largest_error(tracker.mesh(), now.time), now.time);
}

}  // namespace

int main() {
  try {
    roll();
  } catch (const kappaflow::Error& error) {
    std::fprintf(stderr, "ball: error: %s\n", error.what());
    return error.exit_code();
  }
}
