// The parts that a replacement is made of: boundary loops, strips, local isosurfaces, regions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/connectivity.h"
#include "core/nearest_on_triangle.h"
#include "surface/mesh/lattice_blocks.h"
#include "surface/mesh/local_isosurface.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/mesh/self_intersection.h"
#include "surface/topology/disagreement.h"
#include "surface/topology/loops.h"
#include "surface/topology/region_replacement.h"
#include "surface/topology/vertex_cells.h"
#include "tests/surface/mesh/analytic_fields.h"

namespace kappaflow {
namespace {

using testing::EllipsoidField;
using testing::TorusField;

/// A loop of n points on a circle of the given radius about z, at height z, starting anywhere.
std::vector<int> circle(int n, double radius, double z, double start, std::vector<Vec3>& position) {
  std::vector<int> loop;
  for (int i = 0; i < n; ++i) {
    const double angle = start + 2 * std::numbers::pi * i / n;
    loop.push_back(static_cast<int>(position.size()));
    position.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return loop;
}

TEST(Strip, BetweenCirclesIsACylinderWhateverTheirStarts) {
  for (const auto& [m, n, start] :
       {std::tuple(12, 12, 0.0), std::tuple(12, 20, 1.0), std::tuple(31, 9, 4.0)}) {
    std::vector<Vec3> position;
    const std::vector<int> lower = circle(m, 1, 0, 0, position), upper = circle(n, 1, 0.4, start, position);
    std::vector<Vec3> gradient;
    for (const Vec3& x : position) gradient.emplace_back(-x[0], -x[1], 0);
    const std::vector<int> polygon = bridged_polygon(position, gradient, lower, {{upper}});
    const std::vector<Triangle> strip = fill_polygon(position, gradient, polygon, {});
    EXPECT_EQ(strip.size(), static_cast<std::size_t>(m + n));
    double area = 0;
    for (const auto& [a, b, c] : strip) {
      const Vec3 normal = (position[b] - position[a]).cross(position[c] - position[a]);
      area += 0.5 * normal.norm();
      EXPECT_GT(normal.dot(position[a] + position[b] + position[c] - Vec3(0, 0, normal[2])), 0);
    }
    EXPECT_NEAR(area, 2 * std::numbers::pi * 0.4, 0.1);
    // Its boundary: the lower loop as it runs, the upper one against its run.
    const Boundary boundary = boundary_of(strip);
    ASSERT_EQ(boundary.loops.size(), 2u);
    EXPECT_EQ(boundary.loops[0], lower);
    std::vector<int> reversed(upper.rbegin(), upper.rend());
    std::ranges::rotate(reversed, reversed.end() - 1);
    EXPECT_EQ(boundary.loops[1], reversed);
  }
}

TEST(Fill, OfACircleIsADisc) {
  std::vector<Vec3> position;
  const std::vector<int> loop = circle(17, 1, 0, 0.3, position);
  const std::vector<Vec3> gradient(position.size(), Vec3(0, 0, -1));
  const std::vector<Triangle> disc = fill_polygon(position, gradient, loop, {});
  EXPECT_EQ(disc.size(), 15u);
  double area = 0;
  for (const auto& [a, b, c] : disc)
    area += 0.5 * (position[b] - position[a]).cross(position[c] - position[a])[2];
  EXPECT_NEAR(area, 17 * 0.5 * std::sin(2 * std::numbers::pi / 17), 1e-12);
  ASSERT_EQ(boundary_of(disc).loops.size(), 1u);
  EXPECT_EQ(boundary_of(disc).loops[0], loop);
}

/// Sum of signed areas seen from above.
double area_of(std::span<const Vec3> position, std::span<const Triangle> triangles) {
  double area = 0;
  for (const auto& [a, b, c] : triangles)
    area += 0.5 * (position[b] - position[a]).cross(position[c] - position[a])[2];
  return area;
}

/// Corners of a polygon, so many a unit of length.
std::vector<int> outline(std::span<const Vec3> corners, int per_length, std::vector<Vec3>& position) {
  std::vector<int> loop;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const Vec3 along = corners[(c + 1) % corners.size()] - corners[c];
    const int n = static_cast<int>(std::lround(along.norm() * per_length));
    for (int i = 0; i < n; ++i) {
      loop.push_back(static_cast<int>(position.size()));
      position.emplace_back(corners[c] + along * i / n);
    }
  }
  return loop;
}

TEST(Fill, AroundTwoIslandsHoldsAllThreeLoops) {
  std::vector<Vec3> position;
  const Vec3 box[] = {{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {0, 2, 0}},
             left[] = {{0.4, 0.5, 0}, {1.4, 0.5, 0}, {1.4, 1.5, 0}, {0.4, 1.5, 0}},
             right[] = {{2.5, 0.5, 0}, {3.5, 0.5, 0}, {3.5, 1.5, 0}, {2.5, 1.5, 0}};
  const std::vector<int> hole = outline(box, 3, position);
  const std::vector<std::vector<int>> islands{outline(left, 4, position), outline(right, 5, position)};
  const std::vector<Vec3> gradient(position.size(), Vec3(0, 0, -1));
  const std::vector<Triangle> seam =
      fill_polygon(position, gradient, bridged_polygon(position, gradient, hole, islands), {});
  EXPECT_NEAR(area_of(position, seam), 8 - 1 - 1, 1e-12);
  // Euler: V - E + F = -1 for a disc with two holes, and F triangles have (3 F + V) / 2 edges, all V at the
  // rim.
  EXPECT_EQ(seam.size(), position.size() + 2);
  std::vector<Triangle> all = seam;
  for (const std::vector<int>& island : islands)
    for (const Triangle& t : fill_polygon(position, gradient, island, {})) all.push_back(t);
  const Boundary boundary = boundary_of(all);  // the islands' loops run as those of the seam's other side
  ASSERT_EQ(boundary.loops.size(), 1u);
  EXPECT_EQ(boundary.loops[0], hole);
  EXPECT_NEAR(area_of(position, all), 8, 1e-12);
}

TEST(Fill, ZipsASlotThatThePatchDoesNotReach) {
  // A square with a slot three times as long as the square's gap is wide.
  std::vector<Vec3> position;
  const Vec3 keyhole[] = {{0, 0, 0},   {2, 0, 0},   {2, 0.9, 0}, {5, 0.9, 0},
                          {5, 1.1, 0}, {2, 1.1, 0}, {2, 2, 0},   {0, 2, 0}},
             patch[] = {{0.5, 0.5, 0}, {1.5, 0.5, 0}, {1.5, 1.5, 0}, {0.5, 1.5, 0}};
  const std::vector<int> hole = outline(keyhole, 5, position);
  const std::vector<std::vector<int>> inside{outline(patch, 5, position)};
  const std::vector<Vec3> gradient(position.size(), Vec3(0, 0, -1));
  const std::vector<int> polygon = bridged_polygon(position, gradient, hole, inside);
  FillRules rules;
  rules.longest_edge = 0.8;
  const std::vector<Triangle> seam = fill_polygon(position, gradient, polygon, rules);
  EXPECT_NEAR(area_of(position, seam), 4 + 0.6 - 1, 1e-12);
  double longest = 0;
  for (const auto& [a, b, c] : seam)
    for (const auto& [u, v] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      longest = std::max(longest, (position[u] - position[v]).norm());
  EXPECT_LE(longest, 0.8);
  rules.longest_edge = 0.3;  // the gap is 0.5
  EXPECT_TRUE(fill_polygon(position, gradient, polygon, rules).empty());
}

TEST(Fill, TakesNeitherRefusedTrianglesNorTakenEdges) {
  const std::vector<Vec3> position{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, gradient(4, Vec3(0, 0, -1));
  const std::vector<int> square{0, 1, 2, 3};
  const auto diagonal = [&](const FillRules& rules) {
    const std::vector<Triangle> two = fill_polygon(position, gradient, square, rules);
    EXPECT_EQ(two.size(), 2u);
    const auto holds = [&](int v) {
      return std::ranges::all_of(two, [&](const Triangle& t) { return std::ranges::count(t, v) == 1; });
    };
    return holds(0) && holds(2) ? std::pair(0, 2) : std::pair(1, 3);
  };
  EXPECT_EQ(diagonal({.taken_edges = {{0, 2}}, .refused = {}}), std::pair(1, 3));
  EXPECT_EQ(diagonal({.taken_edges = {{1, 3}}, .refused = {}}), std::pair(0, 2));
  EXPECT_EQ(diagonal({.taken_edges = {}, .refused = {{0, 1, 2}}}), std::pair(1, 3));
  EXPECT_EQ(diagonal({.taken_edges = {}, .refused = {{0, 1, 3}}}), std::pair(0, 2));
  EXPECT_TRUE(
      fill_polygon(position, gradient, square, {.taken_edges = {{0, 2}, {1, 3}}, .refused = {}}).empty());
}

/// All of f = 0 in the block.
LocalIsosurface all_in_block(const Field& field, const SampledField& lattice, const LatticeBlock& block,
                             double tolerance) {
  std::vector<std::array<int, 3>> cells;
  for (int k = block.first[2]; k < block.last[2]; ++k)
    for (int j = block.first[1]; j < block.last[1]; ++j)
      for (int i = block.first[0]; i < block.last[0]; ++i) cells.push_back({i, j, k});
  return local_isosurface(field, lattice, block, tolerance, cells,
                          [](const Vec3&, const Vec3&) { return false; });
}

TEST(LocalIsosurface, VerticesAreOnTheSurfaceAndPiecesAddUp) {
  const TorusField field(1, 0.4);
  const SampledField lattice = isosurface_lattice(field, 0.15);
  const auto& dims = lattice.dims;
  const TriangleMesh whole = extract_isosurface(field, 0.15);
  std::size_t triangles = 0;
  const int middle = dims[0] / 2;
  for (const auto& [first, last] : {std::pair(0, middle), std::pair(middle, dims[0] - 1)}) {
    const LocalIsosurface part =
        all_in_block(field, lattice, {{first, 0, 0}, {last, dims[1] - 1, dims[2] - 1}}, 1e-9);
    triangles += part.triangles.size();
    for (std::size_t v = 0; v < part.position.size(); ++v) {
      const ValueAndGradient at = field.value_and_gradient(part.position[v]);
      EXPECT_LE(std::abs(at.f), 1e-9 * at.g.norm());
      EXPECT_TRUE(part.exact[v]);
      EXPECT_EQ(part.gradient[v], at.g);
      const double plane = (part.position[v][0] - lattice.origin[0]) / lattice.spacing - middle;
      EXPECT_EQ(part.at_side[v] != 0, std::abs(plane) < 1e-9);
    }
    // Two ends of a bent tube: two loops, all of it at the cut.
    const Boundary boundary = boundary_of(part.triangles);
    ASSERT_EQ(boundary.loops.size(), 2u);
    for (const std::vector<int>& loop : boundary.loops)
      for (const int v : loop) EXPECT_TRUE(part.at_side[v]);
  }
  EXPECT_EQ(triangles, whole.triangles.size());
}

TEST(LocalIsosurface, HoldsWhereTheGradientVanishes) {
  // Two equal balls that touch in one point, which is on the lattice.
  const ParticleField field(testing::rotating_particles({Vec3(-0.5, 0, 0), Vec3(0.5, 0, 0)}, 1.0, 0.0),
                            2 * std::pow(0.75, 3), 0);
  const SampledField lattice = isosurface_lattice(field, 0.25);
  const LocalIsosurface iso = all_in_block(
      field, lattice, {{0, 0, 0}, {lattice.dims[0] - 1, lattice.dims[1] - 1, lattice.dims[2] - 1}}, 1e-6);
  EXPECT_TRUE(boundary_of(iso.triangles).loops.empty());
  for (const Vec3& x : iso.position) EXPECT_TRUE(x.allFinite());
}

TEST(LocalIsosurface, IsFollowedFromItsSeedsToWhereItEnds) {
  // Two balls apart: from a cell of the one, up to a plane.
  const ParticleField field(testing::rotating_particles({Vec3(-2, 0, 0), Vec3(2, 0, 0)}, 1.0, 0.0), 0.3, 0);
  const SampledField lattice = isosurface_lattice(field, 0.1);
  const LatticeBlock all{{0, 0, 0}, {lattice.dims[0] - 1, lattice.dims[1] - 1, lattice.dims[2] - 1}};
  const double radius = std::sqrt(1 - std::cbrt(0.3));
  const std::vector<std::array<int, 3>> seeds{
      cell_of(lattice, Vec3(-2, 0, radius)), cell_of(lattice, Vec3(0, 0, 0)), {-5, 0, 0}};
  for (const double end : {1.0, 0.2}) {
    const LocalIsosurface iso = local_isosurface(field, lattice, all, 1e-9, seeds,
                                                 [&](const Vec3& x, const Vec3&) { return x[0] + 2 > end; });
    double furthest = -1;
    for (const Triangle& t : iso.triangles)
      for (const int v : t) {
        EXPECT_NEAR((iso.position[v] - Vec3(-2, 0, 0)).norm(), radius, 1e-6);
        furthest = std::max(furthest, iso.position[v][0] + 2);
      }
    EXPECT_LE(furthest, end);
    EXPECT_GT(furthest, std::min(end, radius) - 0.1);
    EXPECT_EQ(boundary_of(iso.triangles).loops.size(), end < radius ? 1u : 0u);
  }
}

TEST(VertexCells, HoldThoseOfABlock) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> along(-3, 3);
  SampledField lattice;
  lattice.spacing = 0.1;
  TriangleMesh mesh;
  VertexCells cells(lattice);
  for (int round = 0; round < 2; ++round) {
    for (int n = 0; n < 300; ++n) mesh.position.emplace_back(along(random), along(random), along(random));
    cells.add(mesh);
    const LatticeBlock block{{-12, -7, 0}, {5, 9, 20}};
    std::vector<int> found;
    cells.for_each_in(block, [&](int v) { found.push_back(v); });
    EXPECT_LT(found.size(), mesh.vertex_count() / 2);
    std::ranges::sort(found);
    EXPECT_EQ(std::ranges::adjacent_find(found), found.end());
    for (int v = 0; v < static_cast<int>(mesh.vertex_count()); ++v) {
      const LatticeCell c = cell_of(lattice, mesh.position[v]);
      bool inside = true;
      for (int a = 0; a < 3; ++a) inside = inside && c[a] >= block.first[a] && c[a] <= block.last[a];
      EXPECT_TRUE(!inside || std::ranges::binary_search(found, v)) << v;
    }
  }
}

TEST(Regions, ThatAreRefusedCountUntilTheyAreTriedAgain) {
  // A ball with a mesh and one without. No seam can be on the surface where no distance is allowed: what
  // needs one is refused, and what does not, the ball without a mesh, is replaced.
  const ParticleField one(testing::rotating_particles({Vec3(-2, 0, 0)}, 1.0, 0.0), 0.3, 0),
      both(testing::rotating_particles({Vec3(-2, 0, 0), Vec3(0, 0, 0)}, 1.0, 0.0), 0.3, 0);
  const double edge = 0.04, radius = std::sqrt(1 - std::cbrt(0.3));
  TriangleMesh mesh = extract_isosurface(one, edge);
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    mesh.gradient[v] = both.value_and_gradient(mesh.position[v]).g;
  const std::size_t vertices = mesh.vertex_count();
  const SampledField lattice = isosurface_lattice(both, edge);
  const ReplacementSetting setting{both, lattice, edge, 1e-6, 0.18 * edge, -1, false};
  const auto cell_at = [&](double x, double y) { return std::vector{cell_of(lattice, Vec3(x, y, 0.001))}; };
  const auto above = cell_at(-2, radius), below = cell_at(-2, -radius), other = cell_at(0, radius);
  MeshEdits edits;
  edits.start(mesh);
  VertexCells cells(lattice);
  Replaced replaced;
  replace_regions(setting, {above, other}, 1, edits, cells, replaced);
  EXPECT_EQ(replaced.refused.size(), 1u);
  EXPECT_EQ(replaced.regions, 1u);
  replace_regions(setting, {below}, 1, edits, cells, replaced);
  EXPECT_EQ(replaced.refused.size(), 2u);
  replace_regions(setting, {above}, 1, edits, cells, replaced);
  EXPECT_EQ(replaced.refused.size(), 2u) << "once more, and not twice";
  edits.drop_removed_triangles();
  edits.finish();
  EXPECT_GT(mesh.vertex_count(), vertices + 100);
  EXPECT_EQ(mesh_topology(mesh.position, mesh.triangles).components, 2);
}

TEST(IntersectingTriangles, AreThoseOfThePairs) {
  const EllipsoidField ball(Vec3::Zero(), Mat3::Identity(), Vec3(1, 0.93, 0.87));
  const TriangleMesh one = extract_isosurface(ball, 0.3);
  EXPECT_TRUE(intersecting_triangles(one.position, one.triangles).empty());
  std::vector<Vec3> position = one.position;
  std::vector<Triangle> triangles = one.triangles;
  const int n = static_cast<int>(position.size());
  for (const Vec3& x : one.position) position.emplace_back(x + Vec3(1.23, 0.1, 0.2));
  for (const auto& [a, b, c] : one.triangles) triangles.push_back({n + a, n + b, n + c});
  const std::vector<int> crossing = intersecting_triangles(position, triangles);
  EXPECT_GT(crossing.size(), 20u);
  EXPECT_EQ(intersecting_triangles(position, triangles, one.triangles.size()), crossing)
      << "neither ball crosses itself";
  EXPECT_TRUE(intersecting_triangles(position, triangles, triangles.size()).empty()) << "none is new";
  EXPECT_TRUE(std::ranges::is_sorted(crossing));
  // Every one of them crosses another, and the rest crosses nothing.
  std::vector<Triangle> rest;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
    if (!std::ranges::binary_search(crossing, t)) rest.push_back(triangles[t]);
  EXPECT_EQ(self_intersections(position, rest), 0u);
  for (const int t : crossing) {
    std::vector<Triangle> with = rest;
    for (const int other : crossing)
      if ((other < static_cast<int>(one.triangles.size())) != (t < static_cast<int>(one.triangles.size())))
        with.push_back(triangles[other]);
    with.push_back(triangles[t]);
    EXPECT_GT(self_intersections(position, with), 0u);
  }
}

TEST(NearestOnTriangle, WeightsGiveThePointBack) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> along(-1, 1);
  const auto point = [&] { return Vec3(along(random), along(random), along(random)); };
  for (int n = 0; n < 100; ++n) {
    const std::array<Vec3, 3> triangle{point(), point(), point()};
    const Vec3 x = point(), nearest = nearest_on_triangle(triangle, x).point;
    const Vec3 w = corner_weights(triangle, nearest);
    EXPECT_NEAR(w.sum(), 1, 1e-12);
    EXPECT_GE(w.minCoeff(), -1e-9);
    EXPECT_LT((w[0] * triangle[0] + w[1] * triangle[1] + w[2] * triangle[2] - nearest).norm(), 1e-9);
  }
  EXPECT_TRUE(corner_weights({Vec3::Ones(), Vec3::Ones(), Vec3::Ones()}, Vec3::Zero())
                  .isApprox(Vec3::Constant(1.0 / 3)));
}

}  // namespace
}  // namespace kappaflow
