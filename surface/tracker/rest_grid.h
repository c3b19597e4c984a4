// Rest positions that are carried along on a grid: what one uses who textures the liquids of grids.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "surface/field/field.h"

namespace kappaflow {

/// Rest positions X at the points of a lattice near the liquid, which its velocity u carries: DX/Dt = 0, by
/// semi-Lagrangian steps (midpoint rule in time, trilinear in space) with back and forth error compensation
/// and correction (BFECC: Kim, Liu, Llamas & Rossignac 2005). With A a step from t0 to t1 and B one back,
///   X* = X + (X - B A X)/2,    X(t1) = A X*,
/// within the range of X at the corners of the cell that the step comes from (Selle et al. 2008). X* = X
/// where B would read points outside. The points are those in the liquid, and half a spacing around it;
/// outside, as far as a cell's corners are, X is continued linearly along the axes. It is so too where a step
/// comes from outside, and it is the point's own place further than three points from where it is known.
class RestGrid {
 public:
  /// X = x near the field. spacing: of the lattice [m].
  RestGrid(const Field& field, double spacing);

  /// From motion.t0(), where the last step ended, to motion.t1().
  void step(FieldMotion& motion);

  /// X at x [m]; nullopt where it is not known at all corners of the cell.
  std::optional<Vec3> at(const Vec3& x) const;

  /// See core/saved_state.h; for a grid of the same spacing.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(origin_, band_.blocks, band_.rest, band_.known);
  }

 private:
  using Place = std::array<int, 3>;  // z, y, x
  enum Known : char { no, continued, carried };

  /// Blocks of kSide^3 points.
  struct Band {
    std::vector<Place> blocks;  // ascending: where each begins, in units of kSide
    std::vector<Vec3> rest;     // [m]
    std::vector<char> known;    // Known

    std::ptrdiff_t find(const Place& point) const;  // -1: none
    Place place_of(std::size_t point) const;        // what find() finds there
  };
  /// Of the corners of a cell.
  struct Sample {
    Vec3 value, least, most;
  };

  void find_blocks(const Field& field, Band& band) const;
  Vec3 place_of(const Band& band, std::size_t point) const;
  std::optional<Sample> sample(const Band& band, std::span<const Vec3> values, const Vec3& x) const;
  std::optional<Vec3> continued_at(std::size_t point) const;
  void trace_back(FieldMotion& motion);
  void correct(FieldMotion& motion);
  void continue_next();

  Vec3 origin_;
  double spacing_;
  Band band_, next_;  // at the last step's end, and while a step is taken at its own
  // What a step keeps for the next one to use again, by the points of next_, and of band_.
  std::vector<Vec3> from_, found_, corrected_;
  std::vector<char> is_inside_, is_found_;
};

}  // namespace kappaflow
