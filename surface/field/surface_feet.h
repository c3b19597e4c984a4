// The surface as points with normals, one below or above each particle near it, and what is smooth about it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/cell_grid.h"
#include "surface/field/field.h"
#include "surface/field/field_kernels.h"

namespace kappaflow {

/// The point of a level set that Newton's method reaches from a particle.
struct Foot {
  Vec3 position = Vec3::Zero();
  Vec3 normal = Vec3::Zero();   ///< of the level set, outward
  double distance = kInfinity;  ///< from its particle [sigma]; infinite: the particle has none
};

/// Takes each foot that is at a finite distance along the gradient to f = 0, in so many steps of at most 0.4
/// sigma; those that do not come there, or leave the ball of `farthest` sigma about their origin, have none.
/// One entry a foot.
void walk_to_surface(const Field& field, std::span<const Vec3> origin, std::span<const double> sigma,
                     int steps, double farthest, std::vector<Foot>& feet);

/// Sums over feet around a point. Weights fall as (1 - r^2/radius^2)^3 with the distance r, with the angle
/// between normals, and as (1 - t^2)^2 with t the distance of the particle over 1.3 sigma: the outermost ones
/// tell best.
class SurfaceFeet {
 public:
  /// sigma: of each foot's particle [m]. radius: of the window around a foot [sigma].
  SurfaceFeet(std::span<const Foot> feet, std::span<const double> sigma, double radius);

  /// Normals averaged over the windows around each foot, unit length; zero where there is no foot.
  std::vector<Vec3> smooth_normals(std::span<const Foot> feet) const;

  /// Height of the surface, smoothed, above each foot along its normal [m]: the mean of
  ///   h = (n_i + n_j) . (y_j - y_i)/2,
  /// which vanishes for points y of planes and quadrics, with n the smooth normals.
  std::vector<double> heights(std::span<const Foot> feet, std::span<const Vec3> smooth_normals) const;

  /// The tensor of normals around x, sum of w n n^T with its largest eigenvalue 1, and the distance of the
  /// nearest foot [m], infinite where none is within `radius` [m].
  struct Normals {
    Mat3 tensor = Mat3::Zero();
    double second = 0;  ///< its second eigenvalue: 0 where the surface is flat
    double nearest = kInfinity;
  };
  Normals normals_around(const Vec3& x, double radius) const;

 private:
  std::vector<double> radius_;  // of the window around each foot [m]
  CellGrid grid_;
  std::vector<std::uint32_t> foot_;  // of each, in the grid's order, which all arrays have
  std::array<std::vector<double>, 3> y_, n_;
  std::vector<double> weight_;
};

}  // namespace kappaflow
