// Level sets on grids, moved by OpenVDB: what most of the related work has in place of a tracked mesh.
//
// C++17, and so is all that this includes: OpenVDB 10's own headers are not C++20, with the concepts that
// oneTBB then asks for.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/named.h"
#include "core/types.h"

namespace kappaflow {

/// How the level set phi(x, t) = 0 moves, D phi/Dt = 0.
enum class LevelSetScheme {
  weno5,            ///< HJ-WENO5 in space and TVD-RK3 in time (Osher & Sethian 1988; Jiang & Peng 2000)
  semi_lagrangian,  ///< back by the midpoint rule, trilinear (Strain 1999)
  maccormack,       ///< Selle, Fedkiw, Kim, Liu & Rossignac 2008
  bfecc             ///< Kim, Liu, Llamas & Rossignac 2005
};

/// As tables have them.
inline constexpr Named<LevelSetScheme> kLevelSetSchemes[] = {
    {"level set, HJ-WENO5", LevelSetScheme::weno5},
    {"level set, semi-Lagrangian", LevelSetScheme::semi_lagrangian},
    {"level set, MacCormack", LevelSetScheme::maccormack},
    {"level set, BFECC", LevelSetScheme::bfecc}};

/// Throws IoError with the way to install it unless the program was built with OpenVDB.
void require_openvdb();

/// A signed distance to a surface in a band of three cells on either side of it.
class GridLevelSet {
 public:
  /// Of a closed surface that is oriented outward. spacing: of the grid [m].
  GridLevelSet(const TriangleSurface& surface, double spacing, LevelSetScheme scheme);
  GridLevelSet(GridLevelSet&& other) noexcept;
  ~GridLevelSet();

  /// Fills in the velocities [m/s] at places [m].
  using Velocities = std::function<void(const std::vector<Vec3>& place, std::vector<Vec3>& velocity)>;

  /// Moves for dt [s] with velocities that stay as they are, and makes it a distance again. fastest: the
  /// largest of them, or more [m/s].
  void advect(const Velocities& velocities, double fastest, double dt);

  /// The surface by dual contouring, oriented outward; empty where nothing is left.
  TriangleSurface surface() const;

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

}  // namespace kappaflow
