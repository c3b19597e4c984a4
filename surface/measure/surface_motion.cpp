#include "surface/measure/surface_motion.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "core/errors.h"
#include "core/parallel.h"
#include "core/quantile.h"
#include "core/solid_distance.h"
#include "surface/mesh/isosurface.h"

namespace kappaflow {
namespace {

constexpr double kMeasuredShare = 0.95;   // of the vertices
constexpr double kMeasuredSpacing = 0.5;  // of the surfaces there, in sigma

}  // namespace

double surface_motion(const Field& before, const Field& after, double sigma) {
  const TriangleMesh from = extract_isosurface(before, kMeasuredSpacing * sigma),
                     to = extract_isosurface(after, kMeasuredSpacing * sigma);
  if (from.triangles.empty() || to.triangles.empty()) return 0;
  const SolidDistance surface(TriangleSurface{from.position, from.triangles});
  std::vector<double> distance(to.vertex_count());
  parallel_for(distance.size(),
               [&](std::size_t v) { distance[v] = std::abs(surface.nearest(to.position[v]).distance); });
  return quantile(distance, kMeasuredShare) / sigma;
}

void check_cloud_motion(const std::string& name, const Field& before, const Field& after, double sigma) {
  const double motion = surface_motion(before, after, sigma);
  if (motion > kLargestCloudMotion)
    throw InvalidInput(
        fmt::format("{}: the surface moves {:.2f} sigma since the frame before; without ids or "
                    "velocities it can be followed up to {} sigma a frame: write frames more "
                    "often, or ids, or set a larger sigma",
                    name, motion, kLargestCloudMotion));
}

}  // namespace kappaflow
