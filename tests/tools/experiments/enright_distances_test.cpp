// Enright's flow as another program might give it: closed meshes of the exact shape, tracked by their
// distance.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "surface/mesh/mesh_distances.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/remesh/initial_mesh.h"
#include "tests/surface/tracker/tracked_images.h"
#include "tests/tools/scratch.h"
#include "tests/vtk_reader.h"
#include "tools/experiments/enright_body.h"
#include "tools/experiments/enright_flow.h"
#include "tools/runs/track.h"

namespace kappaflow {
namespace {

constexpr double kResolution = 0.01;  // [m]

std::shared_ptr<const DistanceImage> image_at(double time) {
  static const TriangleMesh start = initial_mesh(EnrightField(0), kResolution, {.tolerance = 1e-8});
  TriangleSurface shape{start.position, start.triangles};
  carry<EnrightFlow>(shape.vertices, 0, time);
  return std::make_shared<DistanceImage>(signed_distances(shape, kResolution, 12 * kResolution), time);
}

TEST(EnrightDistances, AreTracked) {
  const int frames = 11;
  const double end = 0.5;
  const std::vector<std::string> methods{"normal", "total", "curvature", "regional"};
  const FieldSurfaces surfaces = testing::tracked(
      frames, [&](int k) { return image_at(end * k / (frames - 1)); }, testing::by(methods));
  const EnrightShape shape(end, kResolution);
  for (std::size_t m = 0; m < methods.size(); ++m) {
    const TriangleMesh& mesh = surfaces.mesh(m);
    const ShapeError error = shape.error(mesh);
    const double volume = area_and_volume(mesh.position, mesh.triangles).volume /
                          (4.0 / 3 * std::numbers::pi * std::pow(EnrightFlow::kRadius, 3));
    EXPECT_NEAR(volume, 1, 0.012) << methods[m];
    EXPECT_LT(error.vertex_mean, 0.05 * kResolution) << methods[m];
    EXPECT_LT(error.shape_max, kResolution) << methods[m] << ": nothing of the shape is without a mesh";
    EXPECT_EQ(mesh_topology(mesh.position, mesh.triangles).components, 1) << methods[m];
  }
}

class EnrightMeshes : public Scratch {};

// The body at 0.5 s, as meshes that say nothing of where it comes from but its shapes, is a sphere again.
TEST_F(EnrightMeshes, TrackedBackwardBecomeTheSphere) {
  constexpr double kEdge = 0.02, kRate = 20;  // [m], [1/s]
  constexpr int kFrames = 11;
  const TriangleMesh start = initial_mesh(EnrightField(0), kEdge, {.tolerance = 1e-8});
  for (int k = 0; k < kFrames; ++k) {
    TriangleSurface shape{start.position, start.triangles};
    carry<EnrightFlow>(shape.vertices, 0, k / kRate);
    std::string text;
    for (const Vec3& x : shape.vertices) text += fmt::format("v {} {} {}\n", x.x(), x.y(), x.z());
    for (const Triangle& t : shape.triangles)
      text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    file(fmt::format("m_{}.obj", k), text);
  }
  TrackOptions options;
  options.inputs = {(folder / "m_*.obj").string()};
  options.folder = folder / "out";
  options.quiet = true;
  options.range.backward = true;
  options.frames_per_second = kRate;
  ASSERT_EQ(track(options), 0);
  const auto mesh = read_vtp(folder / fmt::format("out/surface-regional/surface_{:04}.vtp", kFrames - 1));
  const Vec3 centre(EnrightFlow::kCentre.data());
  ASSERT_GT(mesh->GetNumberOfPoints(), 300);
  for (vtkIdType v = 0; v < mesh->GetNumberOfPoints(); ++v)
    EXPECT_NEAR((Vec3(mesh->GetPoint(v)) - centre).norm(), EnrightFlow::kRadius, 0.05 * kEdge);
}

}  // namespace
}  // namespace kappaflow
