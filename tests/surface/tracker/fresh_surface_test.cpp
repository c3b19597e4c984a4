#include "surface/tracker/fresh_surface.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "core/errors.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/motion/material.h"
#include "surface/motion/normal.h"
#include "surface/tracker/tracked_surfaces.h"

namespace kappaflow {
namespace {

constexpr double kSpacing = 0.1, kSigma = 0.2;

/// Affine, about the origin: turned and drawn out along x.
Mat3 motion(double time) {
  const Mat3 turn = Eigen::AngleAxisd(1.5 * time, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  return turn *
         Vec3(1 + 0.05 * time, 1 / std::sqrt(1 + 0.05 * time), 1 / std::sqrt(1 + 0.05 * time)).asDiagonal();
}

/// A ball of 0.55 that moves so.
Particles ball(double time) {
  Particles particles;
  particles.time = time;
  const double step = 1e-5;
  const Mat3 rate = (motion(time + step) - motion(time - step)) / (2 * step);
  for (int k = 0; k < 13 * 13 * 13; ++k) {
    const Vec3 start = kSpacing * Vec3(k % 13 - 6, k / 13 % 13 - 6, k / 169 - 6);
    if (start.norm() > 0.55) continue;
    particles.id.push_back(k);
    particles.position.push_back(motion(time) * start);
    particles.velocity.push_back(rate * start);
  }
  return particles;
}

SurfaceOptions options(std::vector<SurfaceMethod> methods) {
  return {.spacing = kSpacing, .edge_length = 0.4, .velocities = std::move(methods)};
}

/// The mean distance of the rest positions from where the motion had the vertices [sigma].
double rest_error(const TriangleMesh& mesh, double time) {
  const Mat3 back = motion(time).inverse();
  double sum = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    sum += (mesh.rest_position[v] - back * mesh.position[v]).norm();
  return sum / (static_cast<double>(mesh.vertex_count()) * kSigma);
}

TEST(FreshSurface, OfParticlesHasNoDrift) {
  TrackedSurfaces surfaces(ball(0), options({FreshMesh::nearest, evaluate_material, FreshMesh::particles}));
  for (std::size_t m = 0; m < 3; ++m) EXPECT_LT(rest_error(surfaces.mesh(m), 0), 1e-12);
  for (int frame = 1; frame <= 20; ++frame) surfaces.advance(ball(0.1 * frame));
  EXPECT_LT(rest_error(surfaces.mesh(2), 2), 2e-3) << "what the ridge takes of the strain";
  EXPECT_GT(rest_error(surfaces.mesh(0), 2), 0.5) << "the nearest point knows nothing of a turn";
  EXPECT_LT(rest_error(surfaces.mesh(1), 2), 0.1);

  // No step is taken between frames, and nothing is remembered but where particles were.
  TrackedSurfaces rare(ball(0), options({FreshMesh::particles}));
  rare.advance(ball(2));
  const TriangleMesh &often = surfaces.mesh(2), &once = rare.mesh();
  ASSERT_EQ(once.triangles, often.triangles);
  for (std::size_t v = 0; v < once.vertex_count(); ++v) {  // fields at other instants round in other ways
    EXPECT_LT((once.position[v] - often.position[v]).norm(), 1e-5 * kSigma);
    EXPECT_LT((once.rest_position[v] - often.rest_position[v]).norm(), 1e-4 * kSigma);
  }
}

/// The mean error of the texture on a grid after the ball has turned by 1.5 rad in frames of so many.
double grid_error(int frames, double edge_length) {
  SurfaceOptions how = options({FreshMesh::grid});
  how.edge_length = edge_length;
  TrackedSurfaces surfaces(ball(0), how);
  EXPECT_LT(rest_error(surfaces.mesh(), 0), 1e-12);
  for (int frame = 1; frame <= frames; ++frame) surfaces.advance(ball(1.0 * frame / frames));
  return rest_error(surfaces.mesh(), 1);
}

// X is an affine function of x, which interpolation does not change: what is left comes from the border,
// where it is continued, and gets less with the spacing.
TEST(FreshSurface, OnAGridTurnsWithTheBody) {
  const double coarse = grid_error(10, 0.4), fine = grid_error(10, 0.25);
  EXPECT_LT(coarse, 0.03);
  EXPECT_LT(fine, 0.6 * coarse);
}

TEST(FreshSurface, IsTheIsosurfaceOfEachFrameWithNewIds) {
  TrackedSurfaces surfaces(ball(0), options({FreshMesh::particles}));
  std::int64_t next_id = surfaces.mesh().next_id;
  for (int frame = 1; frame <= 3; ++frame) {
    surfaces.advance(ball(0.1 * frame));
    const TriangleMesh& mesh = surfaces.mesh();
    EXPECT_EQ(vertices_older_than(mesh, next_id), 0u);
    EXPECT_TRUE(std::ranges::is_sorted(mesh.id));
    next_id = mesh.next_id;
    const MeshTopology topology = mesh_topology(mesh.position, mesh.triangles);
    EXPECT_EQ(topology.components, 1);
    EXPECT_EQ(topology.genus, 0);
    for (const Vec3& x : mesh.position) {
      const ValueAndGradient at = surfaces.field().value_and_gradient(x);
      EXPECT_LT(std::abs(at.f), 2e-4 * at.g.norm() * kSigma);
    }
    const SurfaceState state = surfaces.state();
    EXPECT_EQ(state.motion.velocity.size(), mesh.vertex_count());
    EXPECT_FALSE(slip(state).has_value()) << "nothing moves that could slip";
  }
}

TEST(FreshSurface, NearestPointsHandArraysOn) {
  TrackedSurfaces surfaces(ball(0), options({FreshMesh::nearest}));
  surfaces.add_array<double>("height", Carry::interpolate, -9);
  surfaces.add_array<int>("half", Carry::nearest, -9);
  const auto half = [](const Vec3& x) { return x.y() < 0 ? 0 : 1; };
  for (std::size_t v = 0; v < surfaces.mesh().vertex_count(); ++v) {
    surfaces.array<double>("height")[v] = surfaces.mesh().position[v].y();
    surfaces.array<int>("half")[v] = half(surfaces.mesh().position[v]);
  }
  Particles still = ball(0);
  still.time = 1;
  surfaces.advance(still);
  const TriangleMesh& mesh = surfaces.mesh();
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    EXPECT_NEAR(surfaces.array<double>("height")[v], mesh.rest_position[v].y(), 1e-12);
    EXPECT_LT((mesh.rest_position[v] - mesh.position[v]).norm(), 0.1 * kSigma);
    if (std::abs(mesh.position[v].y()) > 0.5 * kSigma) {
      EXPECT_EQ(surfaces.array<int>("half")[v], half(mesh.position[v]));
    }
  }
}

/// Two balls that move towards each other along x, the left one of source 8, the right one of source 3.
class Meeting {
 public:
  static constexpr double kSpeed = 0.5;

  static Particles balls(double time) {
    Particles both = ball(0);
    const std::size_t n = both.size();
    both.time = time;
    for (std::size_t i = 0; i < n; ++i) {
      both.id.push_back(both.id[i] + 10000);
      both.position.emplace_back(both.position[i] + Vec3(0.8 - kSpeed * time, 0, 0));
      both.velocity.emplace_back(-kSpeed, 0, 0);
      both.position[i].x() += kSpeed * time - 0.8;
      both.velocity[i] = Vec3(kSpeed, 0, 0);
    }
    return both;
  }
  /// Followed until they are one piece.
  static TrackedSurfaces followed(const SurfaceOptions& how) {
    std::vector<int> source(balls(0).size(), 3);
    std::fill_n(source.begin(), source.size() / 2, 8);
    TrackedSurfaces surfaces(balls(0), how);
    surfaces.find_sources(source);
    for (int frame = 1; frame <= 5; ++frame) surfaces.advance(balls(0.1 * frame), source);
    EXPECT_EQ(mesh_topology(surfaces.mesh().position, surfaces.mesh().triangles).components, 1);
    return surfaces;
  }
  /// How far the rest position of a vertex is from where the ball of its source had it [sigma].
  static double rest_error(const TriangleMesh& mesh, std::size_t v) {
    const Vec3 moved((mesh.source[v] == 8 ? 0.5 : -0.5) * kSpeed, 0, 0);
    return (mesh.rest_position[v] - (mesh.position[v] - moved)).norm() / kSigma;
  }
};

TEST(FreshSurface, LiquidsThatMergeKeepTheirTextures) {
  const TrackedSurfaces surfaces = Meeting::followed(options({FreshMesh::particles}));
  const TriangleMesh& mesh = surfaces.mesh();
  std::size_t near = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    EXPECT_LT(Meeting::rest_error(mesh, v), 1e-6) << "at the seam too";
    if (std::abs(mesh.position[v].x()) > 0.3 * kSigma)
      EXPECT_EQ(mesh.source[v], mesh.position[v].x() < 0 ? 8 : 3);
    else
      ++near;
  }
  EXPECT_GT(near, 10u);
}

// The worst method there is: its vertices do not turn with the body.
TEST(Anchor, TakesTheDriftOfAnyMethodAwayAndNothingElse) {
  SurfaceOptions anchored = options({evaluate_normal});
  anchored.anchor = Anchor::particles;
  TrackedSurfaces free(ball(0), options({evaluate_normal})), held(ball(0), anchored);
  for (int frame = 1; frame <= 10; ++frame) {
    free.advance(ball(0.1 * frame));
    held.advance(ball(0.1 * frame));
  }
  EXPECT_GT(rest_error(free.mesh(), 1), 0.5);
  EXPECT_LT(rest_error(held.mesh(), 1), 1e-3);
  EXPECT_EQ(held.mesh().position, free.mesh().position);
  EXPECT_EQ(held.mesh().triangles, free.mesh().triangles);
  EXPECT_EQ(held.mesh().id, free.mesh().id);
}

TEST(Anchor, VerticesStayOnTheirSideOfASeam) {
  SurfaceOptions anchored = options({evaluate_material});
  anchored.anchor = Anchor::particles;
  const TrackedSurfaces free = Meeting::followed(options({evaluate_material})),
                        held = Meeting::followed(anchored);
  EXPECT_EQ(held.mesh().source, free.mesh().source);
  std::size_t off = 0, off_free = 0;
  for (std::size_t v = 0; v < held.mesh().vertex_count(); ++v) {
    off += Meeting::rest_error(held.mesh(), v) > 0.01;
    off_free += Meeting::rest_error(free.mesh(), v) > 0.01;
  }
  EXPECT_LT(off, held.mesh().vertex_count() / 100);
  EXPECT_LE(off, off_free);
}

TEST(FreshSurface, OfParticlesTakesIdsAndOnAGridVelocities) {
  for (const auto& [mesh, message] :
       {std::pair{FreshMesh::particles, "drops: textures from particles take particles with ids"},
        std::pair{FreshMesh::grid, "drops: textures on a grid take particles with velocities"}}) {
    SurfaceOptions cloud = options({mesh});
    cloud.is_cloud = true;
    cloud.name = "drops";
    try {
      const TrackedSurfaces surfaces(ball(0), cloud);
      FAIL();
    } catch (const InvalidInput& error) {
      EXPECT_STREQ(error.what(), message);
    }
  }
}

}  // namespace
}  // namespace kappaflow
