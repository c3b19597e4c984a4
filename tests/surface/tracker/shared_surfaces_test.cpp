// Surfaces that several processes follow together, against those of one.
#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "core/shared_loop.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/motion/total.h"
#include "surface/motion/velocity_methods.h"
#include "surface/tracker/tracked_surfaces.h"
#include "tests/thread_ranks.h"

namespace kappaflow {
namespace {

constexpr double kSpacing = 0.1;

/// Two drops that fly into each other, sheared and jittered.
Particles drops(double time) {
  Particles particles;
  particles.time = time;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> jitter(-0.2 * kSpacing, 0.2 * kSpacing);
  for (const double side : {-1.0, 1.0})
    for (int n = 0; n < 17 * 17 * 17; ++n) {
      const Vec3 x = kSpacing * Vec3(n % 17 - 8, n / 17 % 17 - 8, n / 289 - 8);
      if (x.norm() > 8 * kSpacing) continue;
      const Vec3 start = x + Vec3(side * 0.98, 0, 0) + Vec3(jitter(random), jitter(random), jitter(random));
      const Vec3 velocity(-side + 0.5 * start[1], 0.3 * start[2], -0.4 * start[0]);
      particles.id.push_back(std::ssize(particles.id));
      particles.position.push_back(start + time * velocity);
      particles.velocity.push_back(velocity);
    }
  return particles;
}

struct Surface {
  std::shared_ptr<const Field> field;
  TriangleMesh mesh;
  VertexRings rings;
  std::vector<double> area;
};

/// With vertices in no order of space, as edits leave them.
Surface shuffled_drops() {
  const TrackedSurfaces drop(drops(0.05), {.spacing = kSpacing});
  const TriangleMesh& ordered = drop.mesh();
  std::vector<int> place(ordered.vertex_count());
  std::iota(place.begin(), place.end(), 0);
  std::ranges::shuffle(place, std::mt19937(5));
  std::vector<Vec3> position(place.size());
  for (std::size_t v = 0; v < place.size(); ++v) position[place[v]] = ordered.position[v];
  std::vector<Triangle> triangles = ordered.triangles;
  for (Triangle& t : triangles)
    for (int& v : t) v = place[v];
  Surface s{.field = particle_field(drops(0.05), drop.field_options()),
            .mesh = make_triangle_mesh(std::move(position), std::move(triangles)),
            .rings = {},
            .area = {}};
  s.rings = vertex_rings(s.mesh.vertex_count(), s.mesh.triangles);
  s.area = vertex_areas(s.mesh.position, s.mesh.triangles);
  return s;
}

SurfaceVelocities velocities(const Surface& s, const VelocityFunction& method) {
  SurfaceVelocities result;
  method(*s.field, {s.mesh.position, s.area, s.rings}, {}, result.sized(s.mesh.vertex_count()));
  return result;
}

TEST(SharedSurfaces, VelocitiesAreThoseOfOneProcessToTheBit) {
  const Surface surface = shuffled_drops();
  ASSERT_GT(surface.mesh.vertex_count(), 1500u);
  for (const VelocityMethod& method : velocity_methods()) {
    const SurfaceVelocities alone = velocities(surface, method.evaluate);
    for (const int size : {2, 5})
      on_each_rank(size, [&](Ranks& ranks) {
        const SharedWork shared(&ranks);
        const SurfaceVelocities found = velocities(surface, method.evaluate);
        EXPECT_EQ(found.velocity, alone.velocity) << method.name << " on " << size;
        EXPECT_EQ(found.confidence, alone.confidence) << method.name << " on " << size;
      });
  }
}

/// The drops merge on the way.
std::vector<TriangleMesh> followed_drops() {
  const SurfaceOptions options{.spacing = kSpacing, .velocities = {evaluate_regional, evaluate_total}};
  TrackedSurfaces surfaces(drops(0), options);
  for (const double time : {0.1, 0.2, 0.3}) surfaces.advance(drops(time));
  return {surfaces.mesh(0), surfaces.mesh(1)};
}

TEST(SharedSurfaces, AreThoseOfOneProcessToTheBit) {
  const std::vector<TriangleMesh> alone = followed_drops();
  EXPECT_EQ(mesh_topology(alone[0].position, alone[0].triangles).components, 1);
  on_each_rank(3, [&](Ranks& ranks) {
    const SharedWork shared(&ranks);
    const std::vector<TriangleMesh> found = followed_drops();
    for (const int m : {0, 1}) {
      EXPECT_EQ(found[m].position, alone[m].position) << m;
      EXPECT_EQ(found[m].triangles, alone[m].triangles) << m;
      EXPECT_EQ(found[m].rest_position, alone[m].rest_position) << m;
    }
  });
}

}  // namespace
}  // namespace kappaflow
