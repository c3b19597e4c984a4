// Enright's flow as another program might give it: closed meshes of the exact shape, tracked by their
// distance.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "surface/mesh/mesh_distances.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/remesh/initial_mesh.h"
#include "tests/surface/tracker/tracked_images.h"
#include "tools/experiments/enright_body.h"
#include "tools/experiments/enright_flow.h"

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

}  // namespace
}  // namespace kappaflow
