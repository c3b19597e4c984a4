// Points that move with the material: what a tracked vertex is measured against.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "surface/field/field.h"
#include "surface/tracker/runge_kutta.h"

namespace kappaflow {

/// Points that move with Field::material_velocity. A tracer at whose place the field knows no velocity is
/// lost: it stays where it was at the start of that step, and counts no more.
class MaterialTracers {
 public:
  /// One tracer at each position [m]: those of the initial mesh. Tracer i belongs to vertex i for as long as
  /// the mesh keeps its connectivity.
  explicit MaterialTracers(std::span<const Vec3> position);

  /// Moves the tracers from motion.t0() to motion.t1() by classical Runge-Kutta of order 4.
  void step(FieldMotion& motion);

  std::span<const Vec3> position() const { return position_; }
  std::span<const char> lost() const { return lost_; }  ///< 1 where the tracer is lost
  std::size_t lost_count() const;

 private:
  std::vector<Vec3> position_;
  std::vector<char> lost_;
  RungeKutta runge_kutta_;
  std::vector<Vec3> velocity_, position_t0_;  // scratch
};

/// Mean over the tracers that are not lost of the distance from vertex i to tracer i, over sigma [1]. nullopt
/// where all are lost. Precondition: as many vertices as tracers.
std::optional<double> tracer_distance(std::span<const Vec3> vertex_position, const MaterialTracers& tracers,
                                      double sigma);

}  // namespace kappaflow
