// Surfaces that are given as images of their distance, tracked.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "surface/field/distance_field.h"
#include "surface/motion/velocity_methods.h"
#include "surface/tracker/surface_group.h"

namespace kappaflow::testing {

/// Tracks images 0 to n - 1 of a series by several methods.
template <class ImageAt>
FieldSurfaces tracked(int n, const ImageAt& image_at, const SurfaceOptions& options) {
  std::vector<DistanceMotion::Image> images;
  for (int k = 0; k < n; ++k) images.push_back(image_at(k));
  const auto motion_from = [&](int k) {
    return DistanceMotion(images[k], images[k + 1], k > 0 ? images[k - 1] : nullptr,
                          k + 2 < n ? images[k + 2] : nullptr);
  };
  FieldSurfaces surfaces(motion_from(0).at(images[0]->time()), options);
  for (int k = 0; k + 1 < n; ++k) {
    DistanceMotion motion = motion_from(k);
    const double steps = motion.displacement() / (0.5 * surfaces.length_scale());
    surfaces.step(motion, std::max(1, static_cast<int>(std::ceil(steps))));
    surfaces.settle();
  }
  return surfaces;
}

inline SurfaceOptions by(const std::vector<std::string>& methods) {
  SurfaceOptions options{.edge_length = 0.25, .is_cloud = true};
  for (const std::string& method : methods) options.velocities.push_back(velocity_method(method).evaluate);
  return options;
}

/// Mean distance of a mesh's vertices from where the material of their rest positions is.
template <class MovedTo>
double material_error(const TriangleMesh& mesh, const MovedTo& moved) {
  double sum = 0;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    sum += (mesh.position[v] - moved(mesh.rest_position[v])).norm();
  return sum / static_cast<double>(mesh.vertex_count());
}

}  // namespace kappaflow::testing
