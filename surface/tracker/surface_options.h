// How surfaces are made and tracked, whatever their field is of.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "surface/field/kernel_shapes.h"
#include "surface/field/particle_weights.h"
#include "surface/tracker/particle_origins.h"
#include "surface/tracker/surface_methods.h"
#include "surface/tracker/tracker_options.h"

namespace kappaflow {

/// How a surface is defined, meshed and tracked. The defaults suit liquids. Of a surface that is not of
/// particles, its field says what sigma is: Field::length_scale().
struct SurfaceOptions {
  double sigma = 2;  ///< support radius of Eq. 12 in particle spacings
  std::optional<double>
      spacing{};  ///< of the particles [m]; empty: measured, particle_spacing() of the first
  /// T of Eq. 12; empty: half the median of the field at the first particles.
  std::optional<double> threshold{};
  WeightRule weights = WeightRule::uniform;
  Kernels kernels = Kernels::round;
  double edge_length = 0.5;  ///< of the mesh where it is flat, in units of sigma
  bool remesh = true;        ///< whether the mesh's connectivity follows the surface
  bool topology = true;      ///< and whether its topology does
  /// Whether velocities are unknown, all zero, and ids pair no particle with itself at another instant.
  bool is_cloud = false;
  /// The fast particles move by this at most in one step, in units of sigma; infinite: the caller's instants
  /// are the steps.
  double motion_per_step = 1.0;
  /// One surface for each, all from the same first mesh: moved by a velocity or meshed anew in every frame;
  /// empty: evaluate_material, or evaluate_regional for a point cloud.
  std::vector<SurfaceMethod> velocities{};
  Anchor anchor = Anchor::none;  ///< of the surfaces that move by a velocity
  TrackerOptions tracker{};  ///< method, remeshing.edge_length and topology.follows_field follow from above
  std::string name = "the particles";  ///< how errors begin
};

}  // namespace kappaflow
