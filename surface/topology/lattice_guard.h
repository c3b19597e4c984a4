// Keeps edits of a mesh from changing what a lattice sees of the surface.
#pragma once

#include "surface/field/field.h"
#include "surface/mesh/mesh_edits.h"

namespace kappaflow {

/// A mesh that agrees with f = 0 at the points of a lattice (see cells_in_dispute()) shall not disagree
/// because of an edit. The gradient and the corners' normals do not tell: an edit across a neck or a slit as
/// thin as the lattice's spacing may look good from all sides.
class LatticeGuard final : public EditGuard {
 public:
  /// lattice: its values are not read. limit: distance from f = 0 within which a point may be on the wrong
  /// side of a good mesh's chords [m]. The field is borrowed.
  LatticeGuard(const Field& field, const SampledField& lattice, double limit)
      : field_(field), origin_(lattice.origin), spacing_(lattice.spacing), limit_(limit) {}

  /// Whether triangle (a, b, c) may give way to the three other sides of the tetrahedron with x: all points
  /// of the lattice in it come to the side of the mesh where they belong, or are within the limit and simple
  /// points (is_simple()) of the surface's inside.
  bool allows(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) const override;

 private:
  bool may_change_sides(const Vec3& point, double f, const Vec3& gradient) const;
  ValueAndGradient at(const Vec3& point) const {
    return field_.value_and_gradient(origin_ + spacing_ * point);
  }

  const Field& field_;
  Vec3 origin_;
  double spacing_, limit_;
};

}  // namespace kappaflow
