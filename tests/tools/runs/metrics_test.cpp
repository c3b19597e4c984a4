#include "tools/runs/metrics.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/errors.h"
#include "scenes/scene.h"
#include "surface/field/particle_motion.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"
#include "tests/tools/scratch.h"
#include "tools/runs/timings.h"

namespace kappaflow {
namespace {

constexpr double kThreshold = 0.125;  // of one particle: (1 - r^2)^3 = 1/8 at r^2 = 1/2

// One particle of sigma 1 at the origin that moves along x: its surface is a sphere.
std::shared_ptr<const ParticleField> one_particle() {
  const Particles particles{0, {0}, {Vec3::Zero()}, {Vec3(2, 0, 0)}};
  return particle_field(particles, {1, WeightRule::uniform, kThreshold});
}
const double kRadius = std::sqrt(0.5);
const double kVolume = 4.0 / 3.0 * std::numbers::pi * std::pow(kRadius, 3);

TEST(Metrics, SphereOfOneParticle) {
  const auto field = one_particle();
  const TriangleMesh mesh = initial_mesh(*field, 0.1, {});
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  const SurfaceState state = surface_state(*field, mesh, rings, velocity_method("normal").evaluate, {});
  FrameMetrics frame;
  const TriangleMesh isosurface = measure_isosurface(*field, 1, frame);
  const SurfaceMetrics metrics = surface_metrics(*field, isosurface, mesh, state, Vec3(0, 0, 1));
  EXPECT_EQ(metrics.vertices, mesh.vertex_count());
  EXPECT_EQ(metrics.triangles, mesh.triangles.size());
  EXPECT_EQ(metrics.topology.components, 1);
  EXPECT_EQ(metrics.topology.genus, 0);
  EXPECT_EQ(metrics.unprojected, 0u);
  EXPECT_LE(metrics.residual_max, ProjectionOptions().tolerance);
  EXPECT_NEAR(metrics.size.volume, kVolume, 0.02 * kVolume);  // chords: O((edge/R)^2)
  // The normal velocity alone lacks the whole tangential motion, and turns nothing.
  ASSERT_TRUE(metrics.slip.has_value());
  EXPECT_NEAR(*metrics.slip, 1, 1e-6);
  EXPECT_FALSE(metrics.rotation_captured.has_value()) << "a translation has no rotation to capture";
  EXPECT_EQ(metrics.angles_outside, 0);
  EXPECT_EQ(metrics.self_intersections, 0u);
  EXPECT_EQ(metrics.on_lattice.components, 1);
  EXPECT_EQ(metrics.on_lattice.genus, 0);
  EXPECT_EQ(metrics.texture.cracks, 0);
  // The chords of both meshes: h^2 / (6 R) at the middle of a triangle of edge h, and more at longer edges.
  EXPECT_LT(metrics.surface_without_mesh, 0.01);
  EXPECT_LT(metrics.mesh_without_surface, 0.01);
  EXPECT_GT(metrics.mesh_without_surface, 0.001);
}

TEST(Metrics, ResidualIsTheDistanceInSigma) {
  const auto field = one_particle();
  TriangleMesh mesh = initial_mesh(*field, 0.2, {});
  mesh.position[3] *= 1 + 1e-3;
  EXPECT_NEAR(surface_residual(*field, mesh), 1e-3 * kRadius, 1e-3 * 1e-3 + 1e-4);
  mesh.unprojected[3] = 1;
  EXPECT_LE(surface_residual(*field, mesh), ProjectionOptions().tolerance) << "flagged vertices do not count";
}

TEST(Metrics, FreshIsosurface) {
  FrameMetrics metrics;
  measure_isosurface(*one_particle(), 1, metrics);
  EXPECT_NEAR(metrics.isosurface_volume, kVolume, 0.06 * kVolume);  // at 0.25 sigma
  EXPECT_EQ(metrics.isosurface.components, 1);
  EXPECT_EQ(metrics.isosurface.genus, 0);
}

TEST(Metrics, PenetrationIsTheDeepestCentreInSpacings) {
  Scene scene;
  scene.walls.emplace_back().shape = BoxShape{{0, 0, 0}, {1, 1, 1}};
  const WallDistance walls(wall_surfaces(scene));
  const std::vector<Vec3> outside{{2, 0, 0}, {0.5, 1.001, 0.5}},
      inside{{0.5, 0.98, 0.5}, {0.5, 0.99, 0.5}, {2, 2, 2}};
  EXPECT_EQ(penetration_max(outside, walls, 0.1), 0);
  EXPECT_NEAR(penetration_max(inside, walls, 0.1), 0.2, 1e-12);
  EXPECT_EQ(penetration_max(inside, WallDistance({}), 0.1), 0) << "no walls";
}

TEST(Metrics, CompressionIgnoresExpansion) {
  const std::vector<float> density{1000, 1010, 900, 1030};
  const Compression c = compression(density, 1000);
  EXPECT_NEAR(c.mean, 0.01, 1e-7);
  EXPECT_NEAR(c.max, 0.03, 1e-7);
}

TEST(MetricsTable, HasTheDocumentedColumns) {
  EXPECT_EQ(
      metrics_header(),
      "frame,time,method,particles,penetration_max,density_error_mean,density_error_max,vertices,triangles,"
      "residual_max,quality_min,quality_mean,area,volume,isosurface_volume,slip,rotation_captured,"
      "tracer_distance,components,genus,isosurface_components,isosurface_genus,kept_fraction,unprojected,"
      "folded_fraction,angles_outside,self_intersections,texture_jump,texture_cracks,kept_since_frame,"
      "surface_without_mesh,mesh_without_surface,regions_replaced,regions_refused,"
      "components_on_lattice,genus_on_lattice,vertices_replaced\n");
}

TEST(MetricsTable, RowMatchesTheHeader) {
  FrameMetrics frame{7, 0.28, 1000, 0.25, 1.0 / 3.0, 0.02, 0.75, {2, 3}};
  SurfaceMetrics surface;
  surface.vertices = 12;
  surface.triangles = 20;
  surface.residual_max = 1e-5;
  surface.quality = {0.5, 0.9};
  surface.size = {3.5, 0.625};
  surface.rotation_captured = 0.875;
  surface.topology = {1, 4};
  surface.unprojected = 5;
  surface.angles_outside = 0.125;
  surface.self_intersections = 6;
  surface.texture = {0.5, 0.25};
  surface.kept_since_frame = 0.875;
  surface.surface_without_mesh = 1.5;
  surface.mesh_without_surface = 2.5;
  surface.regions_replaced = 8;
  surface.regions_refused = 9;
  surface.on_lattice = {10, 11};
  surface.vertices_replaced = 13;
  EXPECT_EQ(metrics_row(frame, "total", surface),
            "7,0.28,total,1000,0.25,0.333333333333,0.02,12,20,1e-05,0.5,0.9,3.5,0.625,0.75,,0.875,,1,4,2,3,1,"
            "5,0,0.125,6,0.5,0.25,0.875,1.5,2.5,8,9,10,11,13\n");
  EXPECT_EQ(split(metrics_row(frame, "total", surface), ',').size(), split(metrics_header(), ',').size());
}

class MetricsFile : public Scratch {};

TEST_F(MetricsFile, IsReadBackToItsDigits) {
  const std::string first = "0,0,total,8,,,,1,2,3.5,4.5,5.5,6.5,7.5,8.5,,,,9,10,11,12,13.5,14,15.5,16.5,17,",
                    rest = "18.5,19.5,20.5,21.5,22.5,23,24,25,26,27\n",
                    second =
                        "1,0.04,normal,8,0.25,1e-05,0.5,1,2,3.5,4.5,5.5,6.5,7.5,8.5,0.1,0.2,0.3,9,10,11,"
                        "12,13.5,14,15.5,16.5,17,";
  const auto rows = read_metrics(file("metrics.csv", metrics_header() + first + rest + second + rest));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(metrics_row(rows[0].frame, rows[0].method, rows[0].surface), first + rest);
  EXPECT_EQ(metrics_row(rows[1].frame, rows[1].method, rows[1].surface), second + rest);
  EXPECT_FALSE(rows[0].surface.slip.has_value());
  EXPECT_EQ(rows[1].surface.slip, 0.1);
  EXPECT_EQ(rows[1].method, "normal");
  EXPECT_EQ(rows[1].surface.vertices_replaced, 27u);
}

TEST_F(MetricsFile, DamagedOnesAreOneLine) {
  const auto message = [&](const std::string& text) {
    const auto path = file("metrics.csv", text);
    return message_of<IoError>([&] { read_metrics(path); }).substr(path.string().size());
  };
  const std::string row = metrics_row({}, "total", {});
  EXPECT_EQ(message("frame,time\n"), ": is not a table of metrics of this version of kappaflow");
  EXPECT_EQ(message(metrics_header() + row + "1,0.04,total\n"), ": row 2 has too few cells");
  EXPECT_EQ(message(metrics_header() + row.substr(0, row.size() - 1) + ",7\n"), ": row 1 has too many cells");
  EXPECT_EQ(message(metrics_header() + "x" + row), ": row 1 has \"x0\" for a whole number");
  EXPECT_EQ(message(metrics_header() + "0,nul" + row.substr(3)),
            ": row 1 found \"nul\" where a number is needed");
}

TEST(TimingsTable, IsInMillisecondsAndMebibytes) {
  EXPECT_EQ(
      timings_header(),
      "frame,time,method,solver_ms,velocity_ms,fairing_ms,topology_ms,remesh_ms,output_ms,memory_mib\n");
  EXPECT_EQ(timings_row(2, 0.08, "total", {1.5, 0.25, 0.125, 0.5, 0, 0.001}, 64.25),
            "2,0.08,total,1500,250,125,500,0,1,64.2\n");
}

TEST(TimingsTable, MemoryIsWhatTheProgramHolds) {
#ifdef __SANITIZE_THREAD__
  GTEST_SKIP() << "the sanitizer holds four bytes for each of the program's";
#endif
  const double before = resident_memory();
  EXPECT_GT(before, 1);
  const std::vector<char> block(std::size_t{64} << 20, 'x');
  EXPECT_NEAR(resident_memory() - before, 64, 8) << block.size();
}

}  // namespace
}  // namespace kappaflow
