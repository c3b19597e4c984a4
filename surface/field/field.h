// What the tracker and the velocity methods know of a field: a jet at (x, t), a length scale, and nothing
// else.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "surface/field/jet.h"

namespace kappaflow {

/// An axis-aligned box [m]; empty when lower > upper.
struct Bounds {
  Vec3 lower = Vec3::Constant(1);
  Vec3 upper = Vec3::Constant(-1);
  bool empty() const { return (lower.array() > upper.array()).any(); }
};

/// Values of f on a block of a regular lattice: point (i, j, k) is origin + spacing (first_column + i,
/// first_row + j, first_plane + k), index x-fastest. A point's value does not depend on which others are
/// sampled with it.
struct SampledField {
  Vec3 origin = Vec3::Zero();
  double spacing = 0;
  int first_plane = 0;
  std::array<int, 3> dims{0, 0, 0};
  std::vector<float> value;
  int first_column = 0, first_row = 0;
};

/// See Field::first_order_jet() and Field::material_velocity().
struct MovingPoint {
  Jet first_order;
  std::optional<Vec3> material_velocity;
};

/// An implicit surface f(x) = 0 at one instant, f > 0 inside. Const methods may be called from many threads.
class Field {
 public:
  virtual ~Field() = default;

  virtual double time() const = 0;  ///< [s]
  virtual Jet jet(const Vec3& x) const = 0;
  /// The same with how it answers a strain of the material; the default is a field whose level sets the
  /// material carries.
  virtual Jet jet(const Vec3& x, StrainResponse& strain) const {
    strain = {};
    return jet(x);
  }
  /// What Eq. 4 takes of the jet: f, f_t, g, length_scale and fastest_in_reach. The other derivatives may be
  /// zero.
  virtual Jet first_order_jet(const Vec3& x) const { return jet(x); }
  virtual ValueAndGradient value_and_gradient(const Vec3& x) const = 0;

  /// The field whose motion tells how the surface moves along itself: of the same material, and near this
  /// one. A field that smooths away what could be followed has another one than itself.
  virtual const Field& pattern() const { return *this; }

  /// A box outside of which f < 0.
  virtual Bounds bounds() const = 0;
  /// The smallest length on which the field varies (for particles the smallest sigma) [m]; scales steps and
  /// tolerances.
  virtual double length_scale() const = 0;
  /// The largest speed of anything that makes the field [m/s].
  virtual double fastest_speed() const = 0;

  /// Velocity of the material at x [m/s], where the field knows one; nullopt where it does not.
  virtual std::optional<Vec3> material_velocity(const Vec3& /*x*/) const { return std::nullopt; }

  /// Both at once, for fields that then look for what is in reach only once.
  virtual MovingPoint moving_point(const Vec3& x) const { return {first_order_jet(x), material_velocity(x)}; }

  /// Whether the material carries f, Df/Dt = 0, so that material_velocity() meets Eq. 4 by itself.
  virtual bool moves_with_material() const { return false; }

  /// The cubes of a lattice, so many cells wide and numbered from its origin, at whose points alone f may be
  /// positive; ascending by z, y, x. nullopt where the field cannot tell.
  virtual std::optional<std::vector<std::array<int, 3>>> occupied_cubes(const SampledField& /*lattice*/,
                                                                        int /*cells*/) const {
    return std::nullopt;
  }

  /// Fills `samples.value` from its lattice. The default evaluates f point by point, in parallel.
  virtual void sample(SampledField& samples) const;
};

/// A field that moves through one time step. at() is not thread-safe; the returned field is.
class FieldMotion {
 public:
  virtual ~FieldMotion() = default;
  virtual double t0() const = 0;  ///< start of the step [s]
  virtual double t1() const = 0;  ///< end of the step [s]
  /// The field at time t in [t0, t1]. Several trackers that ask for the same t share one field.
  virtual std::shared_ptr<const Field> at(double t) = 0;
  /// Nobody asks for fields at times before t any more: a motion that keeps them may let go of them.
  virtual void forget_before(double /*t*/) {}
};

}  // namespace kappaflow
