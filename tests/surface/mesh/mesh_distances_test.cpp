// Distances from closed meshes, against those from the spheres that the meshes are of.
#include "surface/mesh/mesh_distances.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/errors.h"

namespace kappaflow {
namespace {

/// Adds a sphere of latitudes and longitudes; inward: as a cavity.
void add_sphere(const Vec3& centre, double radius, bool inward, TriangleSurface& surface) {
  constexpr int kRings = 24, kSides = 48;
  const int base = static_cast<int>(surface.vertices.size());
  surface.vertices.push_back(centre + radius * Vec3::UnitZ());
  for (int r = 1; r < kRings; ++r)
    for (int s = 0; s < kSides; ++s) {
      const double theta = std::numbers::pi * r / kRings, phi = 2 * std::numbers::pi * s / kSides;
      surface.vertices.push_back(centre + radius * Vec3(std::sin(theta) * std::cos(phi),
                                                        std::sin(theta) * std::sin(phi), std::cos(theta)));
    }
  surface.vertices.push_back(centre - radius * Vec3::UnitZ());
  const int last = static_cast<int>(surface.vertices.size()) - 1;
  const auto add = [&](int a, int b, int c) {
    surface.triangles.push_back(inward ? Triangle{a, c, b} : Triangle{a, b, c});
  };
  const auto vertex = [&](int r, int s) { return base + 1 + (r - 1) * kSides + s % kSides; };
  for (int s = 0; s < kSides; ++s) {
    add(base, vertex(1, s), vertex(1, s + 1));
    add(last, vertex(kRings - 1, s + 1), vertex(kRings - 1, s));
    for (int r = 1; r + 1 < kRings; ++r) {
      add(vertex(r, s), vertex(r + 1, s), vertex(r + 1, s + 1));
      add(vertex(r, s), vertex(r + 1, s + 1), vertex(r, s + 1));
    }
  }
}

/// The largest difference of distances from those that exact() says, at points that are nearer than 0.3 m to
/// the surface.
template <class Exact>
double largest_error(const SignedDistances& distances, const Exact& exact) {
  const RegularGrid& grid = distances.grid;
  double largest = 0;
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) {
        const double d = exact(grid.point(i, j, k));
        if (std::abs(d) < 0.3)
          largest = std::max(largest, std::abs(distances.value[grid.index(i, j, k)] - d));
      }
  return largest;
}

TEST(MeshDistances, AreThoseFromASphere) {
  TriangleSurface sphere;
  const Vec3 centre(0.3, -0.2, 5);
  add_sphere(centre, 1, false, sphere);
  const SignedDistances distances = signed_distances(sphere, 0.1, 0.6);
  EXPECT_LT(largest_error(distances, [&](const Vec3& x) { return (x - centre).norm() - 1; }), 0.006)
      << "the chords' height is 0.0064 m at most";
  const auto [least, most] = std::ranges::minmax(distances.value);
  EXPECT_NEAR(least, -0.6, 0.02);
  EXPECT_NEAR(most, 0.6, 0.02);
  for (int a = 0; a < 3; ++a) {
    EXPECT_LE(distances.grid.point(0, 0, 0)[a], centre[a] - 1.6 + 1e-9);
    EXPECT_LT(std::abs(std::remainder(distances.grid.point(0, 0, 0)[a], 0.1)), 1e-9)
        << "grids of other meshes fit";
  }
}

TEST(MeshDistances, PiecesThatFaceInwardAreCavities) {
  TriangleSurface shell;
  add_sphere(Vec3::Zero(), 1, false, shell);
  add_sphere(Vec3::Zero(), 0.5, true, shell);
  const SignedDistances distances = signed_distances(shell, 0.05, 0.4);
  const auto exact = [](const Vec3& x) { return std::max(x.norm() - 1, 0.5 - x.norm()); };
  EXPECT_LT(largest_error(distances,
                          [&](const Vec3& x) {
                            return std::abs(x.norm() - 0.75) < 0.1 ? 1.0
                                                                   : exact(x);  // halfway there is a kink
                          }),
            0.005);
}

TEST(MeshDistances, RefuseWhatPassesThroughItself) {
  TriangleSurface twice;
  add_sphere(Vec3::Zero(), 1, false, twice);
  twice.vertices[0] = {0, 0, -1.5};  // the top comes out at the bottom
  EXPECT_THROW(signed_distances(twice, 0.1, 0.4), InvalidInput);
  TriangleSurface small;
  add_sphere(Vec3::Zero(), 1, false, small);
  EXPECT_THROW(signed_distances(small, 1e-4, 0.4), InvalidInput) << "a grid of 2e13 points";
}

}  // namespace
}  // namespace kappaflow
