#include "surface/tracker/mobility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "surface/motion/material.h"
#include "surface/remesh/initial_mesh.h"
#include "surface/tracker/surface_tracker.h"
#include "tests/surface/mesh/analytic_fields.h"

namespace kappaflow {
namespace {

const Vec3 kSpin(0.4, -0.3, 1.2);

/// A sphere whose vertices move with a rotation and a little smooth strain, all of them confident.
struct Moving {
  Moving() {
    const testing::EllipsoidField field(Vec3::Zero(), Mat3::Identity(), Vec3::Ones());
    mesh = initial_mesh(field, 0.15, {});
    rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
    for (const Vec3& x : mesh.position)
      velocities.velocity.emplace_back(kSpin.cross(x) + 0.3 * Vec3(x[1], x[0], 0));
    velocities.confidence.assign(mesh.vertex_count(), 0.9);
  }
  std::vector<double> mobility() const {
    std::vector<double> result(mesh.vertex_count());
    vertex_mobility(rings, velocities, result);
    return result;
  }

  TriangleMesh mesh;
  VertexRings rings;
  SurfaceVelocities velocities;
};

TEST(Mobility, IsTheShareThatTheDampingTookAway) {
  const Moving moving;
  for (const double m : moving.mobility()) EXPECT_NEAR(m, 1 - 0.81, 1e-15);
}

TEST(Mobility, OutliersAreReleasedAndNobodyElse) {
  Moving moving;
  std::vector<std::size_t> wrong;
  for (std::size_t v = 7; v < moving.mesh.vertex_count(); v += 97) wrong.push_back(v);
  ASSERT_GT(wrong.size(), 5u);
  for (const std::size_t v : wrong) moving.velocities.velocity[v] *= -1;
  const std::vector<double> mobility = moving.mobility();
  for (std::size_t v = 0; v < mobility.size(); ++v) {
    const bool is_wrong = std::ranges::count(wrong, v) > 0;
    // At the poles of the rotation there is no velocity to have the wrong sign of.
    if (is_wrong && moving.velocities.velocity[v].norm() < 0.5) continue;
    EXPECT_NEAR(mobility[v], is_wrong ? 1 : 0.19, 1e-12) << v;
  }
}

TEST(Mobility, DoesNotDependOnTheOrderOfTheVertices) {
  Moving moving;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0, 1);
  for (std::size_t v = 0; v < moving.mesh.vertex_count(); ++v) {
    moving.velocities.confidence[v] = any(random);
    if (any(random) < 0.1) moving.velocities.velocity[v] = Vec3(any(random), any(random), any(random));
  }
  const std::vector<double> before = moving.mobility();
  std::vector<int> new_index(moving.mesh.vertex_count());
  std::iota(new_index.begin(), new_index.end(), 0);
  std::ranges::shuffle(new_index, random);
  Moving shuffled = moving;
  for (std::size_t v = 0; v < new_index.size(); ++v) {
    shuffled.velocities.velocity[new_index[v]] = moving.velocities.velocity[v];
    shuffled.velocities.confidence[new_index[v]] = moving.velocities.confidence[v];
  }
  for (Triangle& t : shuffled.mesh.triangles)
    for (int& v : t) v = new_index[v];
  shuffled.rings = vertex_rings(new_index.size(), shuffled.mesh.triangles);
  const std::vector<double> after = shuffled.mobility();
  for (std::size_t v = 0; v < before.size(); ++v) EXPECT_NEAR(after[new_index[v]], before[v], 1e-14) << v;
}

/// Largest distance of a vertex of a rotating ellipsoid from where it would be without fairing [m], after a
/// third of a turn tracked with `material`.
double displaced_by_fairing(FairedVertices moves) {
  const auto track = [](const FairingOptions& fairing) {
    const auto field_at = [](double t) -> std::shared_ptr<const Field> {
      return std::make_shared<testing::EllipsoidField>(Vec3::Zero(), testing::rotation(t * kSpin),
                                                       Vec3(1, 0.7, 0.5), Vec3::Zero(), kSpin, t);
    };
    SurfaceTracker tracker(
        initial_mesh(*field_at(0), 0.12, {}),
        {.method = evaluate_material, .integrator = TimeIntegrator::rk4, .fairing = fairing});
    for (int step = 0; step < 15; ++step) {
      testing::FunctionMotion motion(0.1 * step, 0.1 * (step + 1), field_at);
      tracker.step(motion);
    }
    return tracker.mesh().position;
  };
  const std::vector<Vec3> with = track({.moves = moves}), without = track({.iterations = 0});
  double largest = 0;
  for (std::size_t v = 0; v < with.size(); ++v) largest = std::max(largest, (with[v] - without[v]).norm());
  return largest;
}

// `material` is certain of its velocity everywhere: fairing that moves undetermined vertices only has nothing
// to do.
TEST(Mobility, ConfidentVerticesHoldTheirPlaceInFairing) {
  EXPECT_EQ(displaced_by_fairing(FairedVertices::undetermined), 0);
  // The springs of a body that turns rigidly keep their rest lengths up to the errors of integration and
  // projection.
  EXPECT_GT(displaced_by_fairing(FairedVertices::all), 1e-7);
}

}  // namespace
}  // namespace kappaflow
