// A surface that another program has on a grid: a box that turns about the z axis, as images of its distance.
#pragma once

#include <kappaflow/surface/field/distance_field.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <memory>

/// The distance from a box with round edges, which has turned by `angle` [rad].
inline double distance_from_box(const kappaflow::Vec3& x, double angle) {
  const kappaflow::Vec3 y = Eigen::AngleAxisd(-angle, kappaflow::Vec3::UnitZ()) * x;
  const kappaflow::Vec3 q = y.cwiseAbs() - kappaflow::Vec3(0.4, 0.2, 0.1);
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0) - 0.15;
}

/// One frame: 79 x 79 x 43 points, two centimetres apart. It turns by one radian a second.
inline std::shared_ptr<const kappaflow::DistanceImage> image_of_box(double time) {
  kappaflow::SignedDistances image;
  image.grid.origin = {-0.78, -0.78, -0.42};
  image.grid.spacing = {0.02, 0.02, 0.02};
  image.grid.dims = {79, 79, 43};
  for (int k = 0; k < image.grid.dims[2]; ++k)
    for (int j = 0; j < image.grid.dims[1]; ++j)
      for (int i = 0; i < image.grid.dims[0]; ++i)
        image.value.push_back(static_cast<float>(distance_from_box(image.grid.point(i, j, k), time)));
  return std::make_shared<kappaflow::DistanceImage>(image, time);
}
