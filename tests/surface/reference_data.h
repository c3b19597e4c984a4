// The reference tables in tests/data as C++ values.
#pragma once

#include <string>
#include <vector>

#include "surface/field/curvature.h"
#include "surface/field/field_kernels.h"
#include "surface/field/particle_field.h"

namespace kappaflow::testing {

/// Particles, a point on their surface, and what 60-digit arithmetic says about it.
struct JetCase {
  FieldParticles particles;
  double threshold;
  Vec3 x;
  Jet jet;  // length_scale and fastest_in_reach are not in the table
  CurvatureJet curvature;
};

/// The 40 cases of tests/data/field_jets.json.
std::vector<JetCase> read_jet_cases();

/// Kernels, a point, and what 60-digit arithmetic says about it.
struct KernelCase {
  FieldKernels kernels;
  double threshold;
  Vec3 x;
  Jet jet;  // length_scale and fastest_in_reach are not in the table
};

/// The 16 cases of tests/data/kernel_jets.json.
std::vector<KernelCase> read_kernel_cases();

/// Particles at rest with a threshold that makes a body of them.
struct Body {
  FieldParticles particles;
  double threshold;
};

/// From tests/data/bodies.json: 175 jittered particles, sigma = 0.4 (two spacings), w = 1, half-median
/// threshold.
Body read_body175();
/// Seven unequal particles.
Body read_body_of_seven();

/// Gives every particle the velocity that velocity_at(position) says.
template <class VelocityAt>
void set_velocities(FieldParticles& particles, const VelocityAt& velocity_at) {
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    particles.velocity[i] = velocity_at(particles.position[i]);
}

}  // namespace kappaflow::testing
