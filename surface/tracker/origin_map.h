// Where the liquid at a place has come from, by the particles around.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/cell_grid.h"
#include "core/particles.h"
#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {

/// Where liquid has come from.
struct Origin {
  Vec3 position;  ///< [m]
  int source;     ///< its block or emitter, or kUnknownSource
};

/// The origins of particles, interpolated to any place x by affine moving least squares with the field's
/// kernel, w_i = (1 - |x_i - x|^2/sigma_i^2)^3: of the minimum over a, B of
///   sum_i w_i |X_i - x - R (x_i - x) - a - B (x_i - x)/sigma|^2 + 0.0001 sum_i w_i |B|^2,
/// with X_i the origin of particle i and R the rotation that alone comes nearest, the origin at x is x + a.
/// One side of the particles votes: those of one source whose origins are joined by a chain of others in
/// reach of x, each within two sigma of the next.
class OriginMap {
 public:
  /// origin: one a particle [m]; source: likewise, or empty; sigma: of particles of scale 1 [m].
  OriginMap(const Particles& particles, std::span<const Vec3> origin, std::span<const int> source,
            double sigma);

  struct Voter {
    Vec3 offset;  ///< x_i - x [m]
    Vec3 origin;  ///< X_i [m]
    double weight;
    int source, side;
  };
  struct Side {
    double weight;  ///< of its voters
    int source;
  };
  /// Those in reach of a place; memory that is used again.
  struct Voters {
    std::vector<Voter> all;
    std::vector<Side> sides;
    double weight = 0;  ///< of all
    std::vector<std::size_t> front;
  };

  /// By the side that weighs most, the first of them if several; nullopt where nothing is in reach. May be
  /// called from many threads, each with voters of its own.
  std::optional<Origin> at(const Vec3& x, Voters& voters) const;
  /// own and the side whose origin O is nearest to it, of those of own.source where that is known, taken
  /// together: own + g (O - own). The variance of O = sum c_i (X_i - ...) is
  ///   v = sum c_i^2 r^2 / (1 - 4/n) + (3 |sum c_i (x_i - x)/sigma| |B|)^2,
  /// with r the weighted RMS deviation of the side's particles from their fit and n = (sum w_i)^2 / sum
  /// w_i^2, their number if all weighed alike; up to n = 5 the first term is sum c_i^2 r_0^2, with r_0 the
  /// deviation from a rigid motion. The second term is for what particles in a plane leave open. Where liquid
  /// has been drawn out, an error of the origin is one of up to 1/l times as much in its place now, with l
  /// the least singular value of the origin's gradient R + B/sigma. So O counts as if its error were
  ///   s = max(1, 0.8/l) sqrt(v);
  /// a stretch of 1/0.8 makes none larger. s is infinite up to n = 3 where another side of the same source is
  /// here: so few are what liquid that was drawn out has left, and say nothing of what is between them
  /// (liquids whose sources are unknown are of one). What O - own has beyond s is own's:
  ///   g = max(0, 1 - (s^2/3)/|O - own|^2) min(max((0.4 sigma - s)/(0.2 sigma), 0), 1).
  /// The first factor is that of James & Stein 1961 in three dimensions for the error s; the second keeps own
  /// where O is a guess. nullopt where that side weighs less than a tenth of all.
  std::optional<Origin> at(const Vec3& x, const Origin& own, Voters& voters) const;

 private:
  void find_sides(const Vec3& x, Voters& voters) const;

  CellGrid grid_;
  std::vector<Vec3> position_, origin_;  // in the grid's order, as all here
  std::vector<double> inverse_sigma2_;
  std::vector<int> source_;
  double sigma_, reach_ = 0;
};

/// Each vertex takes rest position and source from the side that weighs most: for a mesh that knows nothing
/// of itself. One out of the particles' reach keeps its own.
void take_origins(const OriginMap& map, TriangleMesh& mesh);

/// Each vertex corrects its rest position by the side that it is of, as far as the particles know, and keeps
/// source and side, so that seams stay where they are. One whose side is hardly there keeps its own.
void correct_origins(const OriginMap& map, TriangleMesh& mesh);

}  // namespace kappaflow
