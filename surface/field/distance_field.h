// Implicit surfaces from elsewhere: signed distances on a grid, at instants.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "surface/field/field.h"
#include "surface/field/grid_spline.h"

namespace kappaflow {

/// A surface as most programs give it that have one on a grid: an image of its distance.
struct SignedDistances {
  RegularGrid grid;
  std::vector<float> value;  ///< distance from the surface, negative inside [m]; one a point
  /// Of the material [m/s], one a point; empty where nobody knows it.
  std::vector<Eigen::Vector3f> velocity{};
};

/// Such an image made smooth: f = -distance as a GridSpline. What is inside at the image's border ends there:
/// the liquid in a tank that the image cuts off has a surface along the border.
class DistanceImage {
 public:
  /// Throws InvalidInput for arrays of another length than the grid's, values that are not finite, or fewer
  /// than two points along an axis.
  DistanceImage(const SignedDistances& distances, double time);

  double time() const { return time_; }  ///< [s]
  const GridSpline& f() const { return f_; }
  /// x, y and z of the velocities; nowhere where there are none.
  const std::array<GridSpline, 3>& velocity() const { return velocity_; }
  bool has_velocity() const { return velocity_[0].grid().dims[0] > 0; }
  /// f beyond the grid, where another image of the series goes on.
  float outside() const { return outside_; }
  double reach() const { return reach_; }  ///< the largest distance that it knows [m]

 private:
  GridSpline f_;
  std::array<GridSpline, 3> velocity_;
  double time_;
  float outside_;
  double reach_;
};

/// Signed distances between instants, f < 0 outside. Its level sets are taken for distances, abs(grad f) = 1,
/// at all times, which is how a strain of the material changes them: near x, f_t + g . u = f g^T E g.
class DistanceField final : public Field {
 public:
  /// f and its rate, on the same grid. fastest_speed [m/s]: see Field.
  DistanceField(GridSpline f, GridSpline rate, std::array<GridSpline, 3> velocity, double fastest_speed,
                double time);

  double time() const override { return time_; }
  Jet jet(const Vec3& x) const override;
  Jet jet(const Vec3& x, StrainResponse& strain) const override;
  ValueAndGradient value_and_gradient(const Vec3& x) const override;
  Bounds bounds() const override;
  /// kLengthScale spacings of the grid, the widest of them.
  double length_scale() const override { return length_scale_; }
  double fastest_speed() const override { return fastest_speed_; }
  std::optional<Vec3> material_velocity(const Vec3& x) const override;
  std::optional<std::vector<std::array<int, 3>>> occupied_cubes(const SampledField& lattice,
                                                                int cells) const override;

  /// As many spacings make a lattice for changes of topology (see TopologyOptions) as fine as the grid.
  static constexpr double kLengthScale = 4;

 private:
  GridSpline f_, rate_;
  std::array<GridSpline, 3> velocity_;
  double length_scale_, fastest_speed_, time_;
};

/// The motion from one image to the next: f is the cubic Hermite interpolant in time, its slopes those of the
/// parabola through three images.
class DistanceMotion final : public FieldMotion {
 public:
  using Image = std::shared_ptr<const DistanceImage>;

  /// before, after: the images around them; null where the series begins or ends. Throws InvalidInput unless
  /// their times ascend and their grids have one origin and spacing, and for images with velocities beside
  /// others without.
  DistanceMotion(Image from, Image to, Image before = nullptr, Image after = nullptr);

  double t0() const override { return images_[1]->time(); }
  double t1() const override { return images_[2]->time(); }
  /// Builds the field at its first use and keeps it. Throws InvalidInput outside [t0, t1].
  std::shared_ptr<const Field> at(double t) override;
  void forget_before(double t) override;

  /// How far the surface moves along its normal from t0 to t1 [m], all but a thousandth of it; 0 where there
  /// is none. What is further away at t1 than its distances reach has no say where it is less than a tenth:
  /// it has vanished.
  double displacement() const { return displacement_; }
  /// How far the material does there, as far as velocities are known [m].
  double material_displacement() const { return material_displacement_; }

 private:
  std::array<Image, 4> images_;  // the first and the last may be null
  double displacement_ = 0, material_displacement_ = 0;
  std::vector<std::shared_ptr<const DistanceField>> fields_;  // those asked for so far
};

}  // namespace kappaflow
