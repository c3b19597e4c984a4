// Points that move with the material: what a tracked vertex is measured against.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "surface/field/field.h"
#include "surface/field/runge_kutta.h"
#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {

/// Points that move with Field::material_velocity. A tracer at whose place the field knows no velocity is
/// lost: it stays where it was at the start of that step, and counts no more.
class MaterialTracers {
 public:
  /// One tracer at each position [m]: those of the initial mesh. Tracer i belongs to the vertex with id i.
  explicit MaterialTracers(std::span<const Vec3> position);

  /// Moves the tracers from motion.t0() to motion.t1() by classical Runge-Kutta of order 4.
  void step(FieldMotion& motion);

  std::span<const Vec3> start() const { return start_; }  ///< where each began [m]
  std::span<const Vec3> position() const { return position_; }
  std::span<const char> lost() const { return lost_; }  ///< 1 where the tracer is lost
  std::size_t lost_count() const;

  /// See core/saved_state.h; for tracers that were made at the same positions.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(position_, lost_);
  }

 private:
  std::vector<Vec3> start_, position_;
  std::vector<char> lost_;
  RungeKutta runge_kutta_;
  std::vector<Vec3> velocity_, position_t0_;  // scratch
};

/// Mean over the vertices of the first mesh that are still there, and whose tracers are not lost, of the
/// distance from vertex to tracer, over sigma [1]. nullopt where there are none. Vertices that edits made
/// have no tracer and no vote, so that the mean flatters a method which loses its worst vertices. mesh: of a
/// tracker that started with a vertex at each tracer.
std::optional<double> tracer_distance(const TriangleMesh& mesh, const MaterialTracers& tracers, double sigma);

}  // namespace kappaflow
