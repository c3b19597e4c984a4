// Rigid walls, ready to be asked for distances.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <span>
#include <vector>

#include "core/body_motion.h"
#include "core/solids.h"

namespace kappaflow {

/// A rigid wall: its surface, the solids that this encloses, and how they move. Copies share all of it but
/// the motion.
class SolidWall {
 public:
  /// surface: at t = 0, closed, oriented outward, as solids_of() takes it. Throws InvalidInput as that and
  /// SolidDistance do.
  explicit SolidWall(TriangleSurface surface, BodyMotion motion = {});

  const TriangleSurface& surface() const { return parts_->surface; }
  const BodyMotion& motion() const { return motion_; }
  std::span<const SolidDistance> solids() const { return parts_->solids; }
  /// The bounding boxes of solids().
  std::span<const Eigen::AlignedBox3d> boxes() const { return parts_->boxes; }

 private:
  struct Parts {
    TriangleSurface surface;
    std::vector<SolidDistance> solids;
    std::vector<Eigen::AlignedBox3d> boxes;
  };

  std::shared_ptr<const Parts> parts_;
  BodyMotion motion_;
};

/// motions: of the surfaces, one each; empty: all at rest. Throws InvalidInput for another number of them,
/// and as SolidWall does.
std::vector<SolidWall> solid_walls(std::span<const TriangleSurface> surfaces,
                                   std::span<const BodyMotion> motions = {});

/// The walls where they are at `time` [s], and at rest there.
std::vector<SolidWall> walls_at(double time, std::span<const SolidWall> walls);

/// As nearest_of_union() of the solids of all walls.
SurfacePoint nearest_of_walls(std::span<const SolidWall> walls, const Vec3& x);

/// Copies of their surfaces.
std::vector<TriangleSurface> surfaces_of(std::span<const SolidWall> walls);

/// Whether one of them moves at some time.
bool any_moves(std::span<const SolidWall> walls);

}  // namespace kappaflow
