// The theory of thin films: viscous liquid that spreads on a plane, by lubrication.
#pragma once

#include <cstddef>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// Liquid on a plane that slopes down along x: the acceleration by gravity down along the plane and into it.
struct FilmLiquid {
  double viscosity = 0;   ///< kinematic [m2/s]
  double down_slope = 0;  ///< g sin(slope) >= 0 [m/s2]
  double into_plane = 0;  ///< g cos(slope) >= 0 [m/s2]
};

/// Square cells on the plane. Nothing leaves the grid: its edges are closed, and are lines of symmetry.
struct FilmGrid {
  Vec2 lower{0, 0};            ///< corner [m]
  double cell = 0;             ///< edge of a cell [m]
  std::size_t nx = 0, ny = 0;  ///< one of ny: plane flow
};

/// The thickness h(x, y, t) of a film without surface tension, Lister, "Viscous flows down an inclined plane
/// from point and line sources" (1992):
///   h_t + div q = source,   q = h^3 / (3 nu) (g sin(slope) e_x - g cos(slope) grad h).
/// Finite volumes, explicit in time: q conserves the volume to rounding; the slope's part is taken upstream,
/// the other with the mean of the two cells' h^3. No thickness falls below 0.
class ThinFilm {
 public:
  ThinFilm(const FilmLiquid& liquid, const FilmGrid& grid);

  /// Of the cell (i, j), h [m].
  double& thickness(std::size_t i, std::size_t j) { return thickness_[j * grid_.nx + i]; }
  double thickness(std::size_t i, std::size_t j) const { return thickness_[j * grid_.nx + i]; }

  /// Liquid rises through the rectangle, as fast everywhere [m/s]; as far as the rectangle is on the grid.
  void set_source(const Vec2& lower, const Vec2& upper, double speed);

  void advance(double time);  ///< until then [s]
  double time() const { return time_; }
  double volume() const;  ///< on the grid [m3]

  /// How far the film reaches from `from` in a direction (a unit vector) [m]: to where it is a tenth as thick
  /// as at its thickest, beyond which the front, steep as a cube root, is a thousandth of its length away.
  double reach(const Vec2& from, const Vec2& direction) const;

 private:
  double at(const Vec2& place) const;
  double longest_step(double thickest) const;
  double time_step(double longest) const;
  void step(double dt);

  FilmLiquid liquid_;
  FilmGrid grid_;
  double time_ = 0;
  std::vector<double> thickness_, cubes_, source_, change_;
};

}  // namespace kappaflow
