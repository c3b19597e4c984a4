// In place of grid_level_set.cpp where there is no OpenVDB.
#include "core/errors.h"
#include "tools/experiments/grid_level_set.h"

namespace kappaflow {

struct GridLevelSet::Grid {};

void require_openvdb() {
  throw IoError(
      "OpenVDB",
      "this program was built without it; tools/setup --openvdb installs it (Debian: libopenvdb-dev), "
      "then run cmake --preset release and build again");
}

GridLevelSet::GridLevelSet(const TriangleSurface&, double, LevelSetScheme) {
  require_openvdb();
}
GridLevelSet::GridLevelSet(GridLevelSet&& other) noexcept = default;
GridLevelSet::~GridLevelSet() = default;
void GridLevelSet::advect(const Velocities&, double, double) {}
TriangleSurface GridLevelSet::surface() const {
  return {};
}

}  // namespace kappaflow
