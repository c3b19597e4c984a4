// How a surface is tracked, and what a step did.
#pragma once

#include <algorithm>
#include <cstddef>

#include "surface/field/projection.h"
#include "surface/field/time_integrator.h"
#include "surface/motion/regional.h"
#include "surface/remesh/remesh_options.h"
#include "surface/topology/topology_options.h"
#include "surface/tracker/fairing_options.h"

namespace kappaflow {

struct TrackerOptions {
  VelocityFunction method = evaluate_regional;  ///< how fast the vertices are; see surface/motion
  TimeIntegrator integrator = TimeIntegrator::rk2;
  VelocityOptions velocity{};
  ProjectionOptions projection{};
  FairingOptions fairing{};
  RemeshOptions remeshing{};
  TopologyOptions topology{};  ///< takes effect where remeshing does
  /// Steps from one repair of the mesh (change of topology and remeshing) to the next, >= 1. Two do where a
  /// step moves the liquid by a third of its particles' spacing at most.
  int repair_interval = 1;
};

/// What one step did, for metrics and timings.
struct TrackerStep {
  std::size_t unprojected = 0;  ///< vertices that are not on the surface after the step
  double residual_max =
      0;  ///< largest |f|/|g| over the projected vertices, in units of Field::length_scale()
  TopologyCounts topology;
  RemeshCounts edits;
  double velocity_seconds = 0;  ///< wall time of the advection
  double fairing_seconds = 0;   ///< wall time of fairing and projection
  double topology_seconds = 0;  ///< wall time of the changes of topology, or of a fresh mesh
  double remesh_seconds = 0;    ///< wall time of the edits
  double texture_seconds = 0;   ///< wall time of textures that no vertex carries along

  /// Both one after the other.
  TrackerStep& operator+=(const TrackerStep& next) {
    unprojected = next.unprojected;
    residual_max = std::max(residual_max, next.residual_max);
    topology += next.topology;
    edits += next.edits;
    velocity_seconds += next.velocity_seconds;
    fairing_seconds += next.fairing_seconds;
    topology_seconds += next.topology_seconds;
    remesh_seconds += next.remesh_seconds;
    texture_seconds += next.texture_seconds;
    return *this;
  }

  /// See core/saved_state.h; without the wall times, which differ from run to run.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(unprojected, residual_max, topology, edits);
  }
};

}  // namespace kappaflow
