#include "surface/measure/traced_texture.h"

#include <gtest/gtest.h>

#include "surface/remesh/initial_mesh.h"
#include "tests/surface/mesh/analytic_fields.h"
#include "tests/surface/tracker/moving_ellipsoid.h"

namespace kappaflow {
namespace {

using testing::moved_with_ellipsoid;
using testing::moving_ellipsoid;

constexpr double kSigma = 0.4;

/// An ellipsoid that has turned for half a second, and tracers on it.
class Traced : public ::testing::Test {
 protected:
  Traced() {
    for (int n = 0; n < 10; ++n) {
      auto motion = moving_ellipsoid(0.05 * n, 0.05 * (n + 1));
      tracers_.step(motion);
    }
    for (Vec3& x : mesh_.position) x = moved_with_ellipsoid(x, 0.5);
  }

  TriangleMesh mesh_ = initial_mesh(*moving_ellipsoid(0, 1).at(0), 0.1, {});
  MaterialTracers tracers_{mesh_.position};
};

TEST_F(Traced, AMeshThatMovesWithTheMaterialHasItsTexture) {
  const TracedTexture texture = traced_texture(mesh_, tracers_, kSigma);
  EXPECT_EQ(std::ranges::count(texture.known, 1), std::ssize(mesh_.position));
  EXPECT_LT(texture_distance(texture, tracers_, kSigma).value(), 1e-5);
  for (Vec3& rest : mesh_.rest_position) rest.x() += 0.5 * kSigma;
  const TracedTexture shifted = traced_texture(mesh_, tracers_, kSigma);
  EXPECT_NEAR(texture_distance(shifted, tracers_, kSigma).value(), 0.5, 1e-5);
  EXPECT_NEAR(texture_flicker(texture, shifted, kSigma).value(), 0.5, 1e-5);
  EXPECT_FALSE(texture_flicker({}, shifted, kSigma).has_value()) << "no frame before";
}

// Another mesh of the same surface, with the map that takes it back to the start: the error is that of linear
// interpolation on triangles of 0.1.
TEST_F(Traced, TheVerticesDoNotMatter) {
  TriangleMesh other = initial_mesh(*moving_ellipsoid(0, 1).at(0.5), 0.12, {});
  const Vec3 shift = moved_with_ellipsoid(Vec3::Zero(), 0.5);
  Mat3 turn;
  for (int a = 0; a < 3; ++a) turn.col(a) = moved_with_ellipsoid(Vec3::Unit(a), 0.5) - shift;
  for (std::size_t v = 0; v < other.vertex_count(); ++v)
    other.rest_position[v] = turn.transpose() * (other.position[v] - shift);
  const auto distance = texture_distance(traced_texture(other, tracers_, kSigma), tracers_, kSigma);
  EXPECT_LT(distance.value(), 0.01);
  EXPECT_FALSE(tracer_distance(other, tracers_, kSigma).value() < 0.1) << "its ids stand for nothing";
}

TEST_F(Traced, WhatIsNotAtTheSurfaceDoesNotCount) {
  TriangleMesh near = mesh_, far = mesh_;
  for (Vec3& x : near.position) x.x() += 0.9 * kAtSurface * kSigma;
  for (Vec3& x : far.position) x.x() += 20 * kSigma;
  EXPECT_EQ(std::ranges::count(traced_texture(near, tracers_, kSigma).known, 1), std::ssize(near.position));
  const TracedTexture none = traced_texture(far, tracers_, kSigma);
  EXPECT_EQ(std::ranges::count(none.known, 1), 0);
  EXPECT_FALSE(texture_distance(none, tracers_, kSigma).has_value());
  EXPECT_FALSE(texture_flicker(traced_texture(mesh_, tracers_, kSigma), none, kSigma).has_value());
}

}  // namespace
}  // namespace kappaflow
