#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "core/errors.h"
#include "surface/mesh/block_isosurface.h"
#include "surface/mesh/lattice_blocks.h"
#include "surface/mesh/mesh_measures.h"
#include "tests/surface/mesh/analytic_fields.h"
#include "tests/surface/mesh/closed_meshes.h"

namespace kappaflow {
namespace {

using testing::EllipsoidField;
using testing::has_single_fans;
using testing::tetrahedra;
using testing::TorusField;

constexpr double kPi = std::numbers::pi;

EllipsoidField sphere(double radius, const Vec3& centre = Vec3::Zero()) {
  return {centre, Mat3::Identity(), Vec3::Constant(radius)};
}

/// Samples of random sign: every configuration of a marching-cubes cell, ambiguous ones included, side by
/// side.
class NoiseField final : public Field {
 public:
  NoiseField(unsigned seed, double inside_share, int cells)
      : seed_(seed), share_(inside_share), cells_(cells) {}
  double time() const override { return 0; }
  Jet jet(const Vec3&) const override { return {}; }
  ValueAndGradient value_and_gradient(const Vec3&) const override { return {}; }
  Bounds bounds() const override { return {Vec3::Zero(), Vec3::Constant(cells_)}; }
  double length_scale() const override { return 1; }
  double fastest_speed() const override { return 0; }
  void sample(SampledField& samples) const override {
    std::uniform_real_distribution<float> uniform(0, 1);
    samples.value.clear();
    const int last = cells_ + 2;  // of the lattice's points in every direction
    for (int k = samples.first_plane; k < samples.first_plane + samples.dims[2]; ++k) {
      std::mt19937 random(1000 * seed_ + static_cast<unsigned>(k));
      for (int j = 0; j <= last; ++j)
        for (int i = 0; i <= last; ++i) {
          const bool outermost = std::min({i, j, k}) == 0 || std::max({i, j, k}) == last;
          const float size = uniform(random);
          samples.value.push_back(!outermost && uniform(random) < static_cast<float>(share_) ? size : -size);
        }
    }
  }

 private:
  unsigned seed_;
  double share_;
  int cells_;
};

TEST(VertexRings, ListEveryNeighbourOnceAscending) {
  const TriangleMesh mesh = extract_isosurface(testing::random_blobs(1, 40, 1.5), 0.3);
  std::vector<std::set<int>> oracle(mesh.vertex_count());
  for (const Triangle& t : mesh.triangles)
    for (const int a : t)
      for (const int b : t)
        if (a != b) oracle[a].insert(b);
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  ASSERT_EQ(rings.start.size(), mesh.vertex_count() + 1);
  for (int v = 0; v < static_cast<int>(mesh.vertex_count()); ++v)
    EXPECT_TRUE(std::ranges::equal(rings.of(v), oracle[v])) << v;
}

TEST(Measures, Tetrahedron) {
  const TriangleMesh mesh = tetrahedra(1);
  const AreaAndVolume measured = area_and_volume(mesh.position, mesh.triangles);
  EXPECT_NEAR(measured.volume, 1.0 / 6, 1e-15);
  EXPECT_NEAR(measured.area, 1.5 + std::sqrt(3.0) / 2, 1e-15);
  const std::vector<double> areas = vertex_areas(mesh.position, mesh.triangles);
  EXPECT_NEAR(areas[0], 0.5, 1e-15);
  EXPECT_NEAR(areas[1], (1 + std::sqrt(3.0) / 2) / 3, 1e-15);
}

TEST(Measures, VolumeDoesNotCancelFarFromTheOrigin) {
  TriangleMesh mesh = tetrahedra(1);
  for (Vec3& x : mesh.position) x += Vec3::Constant(1e5);
  EXPECT_NEAR(area_and_volume(mesh.position, mesh.triangles).volume, 1.0 / 6, 1e-10);
}

TEST(Measures, TriangleQuality) {
  const Vec3 a(0, 0, 0), b(1, 0, 0);
  EXPECT_NEAR(triangle_quality(a, b, Vec3(0.5, std::sqrt(0.75), 0)), 1, 1e-15);
  EXPECT_NEAR(triangle_quality(a, b, Vec3(0, 1, 0)), 2 * (std::sqrt(2.0) - 1), 1e-15);
  EXPECT_EQ(triangle_quality(a, b, Vec3(2, 0, 0)), 0);
  EXPECT_EQ(triangle_quality(a, a, a), 0);
  const Vec3 c(0.3, 0.2, -0.7);
  const double la = (c - b).norm(), lb = c.norm(), lc = 1, s = (la + lb + lc) / 2;
  EXPECT_NEAR(triangle_quality(a, b, c), 8 * (s - la) * (s - lb) * (s - lc) / (la * lb * lc), 1e-14);
}

TEST(Measures, SphereConvergesWithSecondOrder) {
  std::vector<double> area_error, volume_error;
  for (const double spacing : {0.2, 0.1, 0.05}) {
    const TriangleMesh mesh = extract_isosurface(sphere(1.0, Vec3(0.3, -0.2, 7)), spacing);
    const AreaAndVolume measured = area_and_volume(mesh.position, mesh.triangles);
    area_error.push_back(std::abs(measured.area - 4 * kPi));
    volume_error.push_back(std::abs(measured.volume - 4 * kPi / 3));
    const QualityRange quality = triangle_qualities(mesh.position, mesh.triangles);
    EXPECT_GT(quality.min, 0);
    EXPECT_GT(quality.mean, quality.min);
  }
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(std::log2(area_error[i] / area_error[i + 1]), 2, 0.3);
    EXPECT_NEAR(std::log2(volume_error[i] / volume_error[i + 1]), 2, 0.3);
  }
}

TEST(Measures, SameBitsForAnyNumberOfThreads) {
  const TriangleMesh mesh = extract_isosurface(testing::random_blobs(3, 60, 1.6), 0.1);
  std::set<std::pair<double, double>> results;
  std::set<double> qualities;
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const AreaAndVolume measured = area_and_volume(mesh.position, mesh.triangles);
    results.insert({measured.area, measured.volume});
    qualities.insert(triangle_qualities(mesh.position, mesh.triangles).mean);
  }
  EXPECT_EQ(results.size(), 1u);
  EXPECT_EQ(qualities.size(), 1u);
}

TEST(Topology, SphereTorusAndTwoSpheres) {
  const TriangleMesh ball = extract_isosurface(sphere(1), 0.2);
  const TriangleMesh torus = extract_isosurface(TorusField(1, 0.4), 0.1);
  const MeshTopology of_ball = mesh_topology(ball.position, ball.triangles);
  const MeshTopology of_torus = mesh_topology(torus.position, torus.triangles);
  EXPECT_EQ(of_ball.components, 1);
  EXPECT_EQ(of_ball.genus, 0);
  EXPECT_EQ(of_torus.components, 1);
  EXPECT_EQ(of_torus.genus, 1);
  EXPECT_GT(area_and_volume(torus.position, torus.triangles).volume, 0);

  const ParticleField two(testing::rotating_particles({Vec3(-2, 0, 0), Vec3(2, 0, 0)}, 1, 1), 0.3, 0);
  const TriangleMesh pair = extract_isosurface(two, 0.15);
  const MeshTopology of_pair = mesh_topology(pair.position, pair.triangles);
  EXPECT_EQ(of_pair.components, 2);
  EXPECT_EQ(of_pair.genus, 0);
}

TEST(Topology, ComponentsAreNumberedByFirstVertex) {
  const TriangleMesh mesh = tetrahedra(3);
  const std::vector<int> component = vertex_pieces(mesh.vertex_count(), mesh.triangles);
  EXPECT_EQ(component, (std::vector<int>{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2}));
}

TEST(Topology, UnusedVerticesDoNotCount) {
  TriangleMesh mesh = tetrahedra(2);
  mesh.position.insert(mesh.position.begin(), Vec3(9, 9, 9));
  for (Triangle& t : mesh.triangles)
    for (int& v : t) ++v;
  const MeshTopology topology = mesh_topology(mesh.position, mesh.triangles);
  EXPECT_EQ(topology.components, 2);
  EXPECT_EQ(topology.genus, 0);
}

TEST(Topology, OpenMisorientedAndDoubledMeshesAreRefused) {
  const TriangleMesh closed = tetrahedra(1);
  std::vector<Triangle> open = closed.triangles, misoriented = closed.triangles, doubled = closed.triangles;
  open.pop_back();
  std::swap(misoriented[0][0], misoriented[0][1]);
  doubled.push_back(doubled[0]);
  EXPECT_THROW(mesh_topology(closed.position, open), TopologyError);
  EXPECT_THROW(mesh_topology(closed.position, misoriented), TopologyError);
  EXPECT_THROW(mesh_topology(closed.position, doubled), TopologyError);
}

TEST(Isosurface, ClosedManifoldWhateverTheSigns) {
  for (unsigned seed = 0; seed < 25; ++seed) {
    const NoiseField field(seed, 0.1 + 0.03 * seed, 12);
    const TriangleMesh mesh = extract_isosurface(field, 1, seed % 2 == 0 ? 0 : 100000);
    EXPECT_NO_THROW(mesh_topology(mesh.position, mesh.triangles)) << seed;
    EXPECT_TRUE(has_single_fans(mesh)) << seed;
    EXPECT_GT(area_and_volume(mesh.position, mesh.triangles).volume, 0) << seed;
  }
}

TEST(Isosurface, ClosedManifoldOutwardOnBlobs) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const ParticleField field = testing::random_blobs(seed, 120, 2.2);
    const TriangleMesh mesh = extract_isosurface(field, 0.17);
    EXPECT_NO_THROW(mesh_topology(mesh.position, mesh.triangles)) << seed;
    EXPECT_TRUE(has_single_fans(mesh)) << seed;
    // Triangles much smaller than a cell may lie askew; together they are next to nothing.
    double area = 0, inward_area = 0;
    for (const Triangle& t : mesh.triangles) {
      const Vec3 &a = mesh.position[t[0]], &b = mesh.position[t[1]], &c = mesh.position[t[2]];
      const Vec3 twice_area = (b - a).cross(c - a);
      area += twice_area.norm();
      if (twice_area.dot(field.value_and_gradient((a + b + c) / 3).g) > 0) inward_area += twice_area.norm();
    }
    EXPECT_LT(inward_area, 1e-3 * area);
  }
}

/// The cubes of the field as blocks, whatever share of the lattice they are.
std::vector<LatticeBlock> cubes_as_blocks(const Field& field, const SampledField& lattice) {
  std::vector<LatticeBlock> blocks;
  const auto cubes = field.occupied_cubes(lattice, kCubeCells);
  for (const LatticeCube& cube : cubes.value()) {
    LatticeBlock& block = blocks.emplace_back();
    for (int a = 0; a < 3; ++a) {
      block.first[a] = kCubeCells * cube[a];
      block.last[a] = std::min(block.first[a] + kCubeCells, lattice.dims[a] - 1);
    }
  }
  return blocks;
}

std::vector<Vec3> sorted(std::vector<Vec3> points) {
  std::ranges::sort(points, {}, [](const Vec3& x) {
    return std::array{std::round(1e6 * x[0]), std::round(1e6 * x[1]), std::round(1e6 * x[2])};
  });
  return points;
}

TEST(Isosurface, InBlocksIsThatOfTheWholeLattice) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    const ParticleField field = testing::random_blobs(seed, 40, 3);
    const SampledField lattice = isosurface_lattice(field, 0.07);
    const std::vector<LatticeBlock> blocks = cubes_as_blocks(field, lattice);
    EXPECT_GT(blocks.size(), 8u);
    const auto sample = [&](SampledField& samples) { field.sample(samples); };
    const TriangleMesh dense = extract_isosurface(lattice, sample);
    const TriangleMesh sparse = isosurface_in_blocks(lattice, blocks, sample);
    ASSERT_EQ(sparse.vertex_count(), dense.vertex_count());
    EXPECT_EQ(sparse.triangles.size(), dense.triangles.size());
    const std::vector<Vec3> x = sorted(sparse.position), y = sorted(dense.position);
    std::size_t apart = 0;  // rounding may swap two places
    for (std::size_t v = 0; v < x.size(); ++v) apart += (x[v] - y[v]).norm() > 1e-5;
    EXPECT_LT(apart, x.size() / 100);
    EXPECT_EQ(mesh_topology(sparse.position, sparse.triangles).genus,
              mesh_topology(dense.position, dense.triangles).genus);
    EXPECT_NEAR(area_and_volume(sparse.position, sparse.triangles).volume,
                area_and_volume(dense.position, dense.triangles).volume, 1e-5);
  }
}

TEST(Isosurface, CubesHoldAllThatParticlesReach) {
  const ParticleField field = testing::random_blobs(5, 12, 4);
  SampledField lattice = isosurface_lattice(field, 0.1);
  field.sample(lattice);
  constexpr int kCells = 7;
  const auto cubes = field.occupied_cubes(lattice, kCells);
  ASSERT_TRUE(cubes.has_value());
  std::size_t index = 0;
  for (int k = 0; k < lattice.dims[2]; ++k)
    for (int j = 0; j < lattice.dims[1]; ++j)
      for (int i = 0; i < lattice.dims[0]; ++i, ++index)
        if (lattice.value[index] > -0.5f + 1e-6f) {
          EXPECT_TRUE(std::ranges::count(*cubes, LatticeCube{i / kCells, j / kCells, k / kCells}) == 1);
        }
  EXPECT_LT(cubes->size() * kCells * kCells * kCells, lattice.value.size());
}

TEST(Isosurface, OfTwoBodiesFarApartIsThoseOfEach) {
  const std::vector<Vec3> here{Vec3(0, 0, 0), Vec3(0.4, 0.1, 0)};
  std::vector<Vec3> both = here;
  const Vec3 away(1e6, -1e6, 3e5);
  for (const Vec3& x : here) both.emplace_back(x + away);
  const double spacing = 0.0625;  // and the shift a multiple of it: both lie on their lattices alike
  const ParticleField one(testing::rotating_particles(here, 1.0, 0.0), 0.5, 0),
      two(testing::rotating_particles(both, 1.0, 0.0), 0.5, 0);
  const TriangleMesh alone = extract_isosurface(one, spacing), pair = extract_isosurface(two, spacing);
  ASSERT_EQ(pair.vertex_count(), 2 * alone.vertex_count());
  EXPECT_EQ(pair.triangles.size(), 2 * alone.triangles.size());
  EXPECT_EQ(mesh_topology(pair.position, pair.triangles).components, 2);
  std::vector<Vec3> near, far;
  for (const Vec3& x : pair.position) (x[0] < 1e5 ? near : far).push_back(x);
  for (Vec3& x : far) x -= away;
  for (const std::vector<Vec3>& part : {near, far}) {
    const std::vector<Vec3> x = sorted(part), y = sorted(alone.position);
    ASSERT_EQ(x.size(), y.size());
    std::size_t apart = 0;
    for (std::size_t v = 0; v < x.size(); ++v) apart += (x[v] - y[v]).norm() > 1e-5;
    EXPECT_LT(apart, x.size() / 100);
  }
}

TEST(Isosurface, SamplesOfExactlyZeroKeepVerticesApart) {
  // The lattice starts at -1.5: the sphere of radius 1 passes exactly through six of its points.
  const TriangleMesh mesh = extract_isosurface(sphere(1), 0.5);
  EXPECT_EQ(mesh_topology(mesh.position, mesh.triangles).genus, 0);
  const auto less = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  const std::set<Vec3, decltype(less)> distinct(mesh.position.begin(), mesh.position.end());
  EXPECT_EQ(distinct.size(), mesh.vertex_count());
}

TEST(Isosurface, VerticesAreNearTheSurfaceAndAllUsed) {
  const TriangleMesh mesh = extract_isosurface(sphere(1, Vec3(100, 0, 0)), 0.1);
  std::vector<char> used(mesh.vertex_count(), 0);
  for (const Triangle& t : mesh.triangles)
    for (const int v : t) used[v] = 1;
  EXPECT_EQ(std::ranges::count(used, 0), 0);
  for (const Vec3& x : mesh.position) EXPECT_NEAR((x - Vec3(100, 0, 0)).norm(), 1, 0.1 * 0.1 / 4);
  EXPECT_EQ(mesh.rest_position, mesh.position);
  EXPECT_EQ(mesh.unprojected, std::vector<char>(mesh.vertex_count(), 0));
}

TEST(Isosurface, SlabsAreSewnIntoTheSameSurface) {
  const auto field = testing::random_blobs(4, 60, 1.6);
  const TriangleMesh whole = extract_isosurface(field, 0.1);
  const MeshTopology topology = mesh_topology(whole.position, whole.triangles);
  const AreaAndVolume size = area_and_volume(whole.position, whole.triangles);
  for (const std::size_t points : {std::size_t{0}, std::size_t{7000}}) {
    const TriangleMesh sewn = extract_isosurface(field, 0.1, points);
    EXPECT_EQ(sewn.vertex_count(), whole.vertex_count());
    EXPECT_EQ(sewn.triangles.size(), whole.triangles.size());
    EXPECT_EQ(mesh_topology(sewn.position, sewn.triangles).components, topology.components);
    EXPECT_EQ(mesh_topology(sewn.position, sewn.triangles).genus, topology.genus);
    const AreaAndVolume measured = area_and_volume(sewn.position, sewn.triangles);
    EXPECT_NEAR(measured.area, size.area, 1e-5 * size.area);
    EXPECT_NEAR(measured.volume, size.volume, 1e-5 * size.volume);
  }
}

TEST(Isosurface, EmptyFieldsAndWrongSpacings) {
  const ParticleField below(testing::rotating_particles({Vec3::Zero()}, 1, 1), 1.5, 0);
  EXPECT_EQ(extract_isosurface(below, 0.2).vertex_count(), 0u);
  const ParticleField none(FieldParticles{}, 0.5, 0);
  EXPECT_EQ(extract_isosurface(none, 0.2).vertex_count(), 0u);
  for (const double spacing : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW(extract_isosurface(sphere(1), spacing), InvalidInput) << spacing;
  EXPECT_THROW(extract_isosurface(sphere(1), 1e-4), InvalidInput);
}

TEST(TriangleMeasures, ShareOfAnglesOutside) {
  // 90, 53.1 and 36.9 degrees; 26.6, 26.6 and 126.9 degrees
  const std::vector<Vec3> corners{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(4, 3, 0), Vec3(2, 1, 0)};
  const std::vector<Triangle> both{{0, 1, 2}, {0, 1, 3}};
  EXPECT_EQ(angles_outside(corners, both, 15, 140), 0);
  EXPECT_EQ(angles_outside(corners, both, 30, 140), 0.5);
  EXPECT_EQ(angles_outside(corners, both, 15, 120), 0.5);
  EXPECT_EQ(angles_outside(corners, both, 40, 140), 1);
}

TEST(TriangleMeasures, DistortionOfAStretchedTriangle) {
  const std::vector<Triangle> one{{0, 1, 2}};
  const std::vector<Vec3> rest{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, std::sqrt(3.0) / 2, 0)};
  std::vector<Vec3> now = rest;
  const TriangleDistortion none = triangle_distortion(now, rest, one);
  EXPECT_NEAR(none.aspect_max, 1, 1e-15);
  EXPECT_NEAR(none.area_ratio_min, 1, 1e-15);
  for (Vec3& x : now) x[0] *= 4;  // edge 4, altitude sqrt(3)/2: 4 times the equilateral's 2/sqrt(3)
  const TriangleDistortion stretched = triangle_distortion(now, rest, one);
  EXPECT_NEAR(stretched.aspect_mean, 4, 1e-14);
  EXPECT_NEAR(stretched.area_ratio_max, 4, 1e-14);
  now[2] = Vec3(2, 0, 0);
  EXPECT_TRUE(std::isinf(triangle_distortion(now, rest, one).aspect_max));
}

TEST(TriangleMeasures, SmallestAngle) {
  const std::vector<Vec3> corners{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(4, 3, 0), Vec3(8, 0, 0)};
  EXPECT_NEAR(smallest_angle(corners, std::vector<Triangle>{{0, 1, 2}}), 180 / kPi * std::atan2(3, 4), 1e-12);
  EXPECT_EQ(smallest_angle(corners, std::vector<Triangle>{{0, 1, 2}, {0, 1, 3}}), 0);
  EXPECT_NEAR(smallest_angle(corners, std::vector<Triangle>{}), 60, 1e-12);
}

TEST(TriangleMeasures, FoldedTrianglesFaceAwayFromTheNormals) {
  const TriangleMesh mesh = extract_isosurface(sphere(1), 0.3);
  std::vector<Vec3> normal = mesh.position;
  EXPECT_EQ(folded_fraction(mesh.position, normal, mesh.triangles), 0);
  std::vector<Triangle> turned(mesh.triangles.begin(), mesh.triangles.end());
  for (std::size_t t = 0; t < turned.size(); t += 4) std::swap(turned[t][0], turned[t][1]);
  EXPECT_NEAR(folded_fraction(mesh.position, normal, turned), 0.25, 2.0 / static_cast<double>(turned.size()));
}

}  // namespace
}  // namespace kappaflow
