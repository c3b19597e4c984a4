// Kernels that follow the liquid: flat along its surface, their centres moved so that the surface is smooth.
#pragma once

#include <vector>

#include "core/named.h"
#include "surface/field/field_kernels.h"
#include "surface/field/particle_field.h"

namespace kappaflow {

/// Which kernels a field of particles has.
enum class Kernels {
  round,        ///< those of Eq. 12
  anisotropic,  ///< those of kernel_shapes()
};

/// As scenes and the command line have them.
inline constexpr Named<Kernels> kKernels[] = {{"round", Kernels::round},
                                              {"anisotropic", Kernels::anisotropic}};

/// How each particle's kernel differs from the round one. One entry a particle.
struct KernelShapes {
  std::vector<Vec3> offset;            ///< c_i - x_i [m]
  std::vector<SymmetricMatrix> shape;  ///< M_i [1/m2]
  std::vector<double> weight;          ///< w_i of the kernel: its integral is that of the round one [-]

  std::size_t size() const { return offset.size(); }
};

/// Kernels after Yu & Turk (2013), "Reconstructing surfaces of particle-based fluids using anisotropic
/// kernels", that keep the volume: M^-1 = sigma^2 S, where S has the eigenvalues
///   s_a = (1 + 0.69 m - 1.3^2 q_a/2) min(1, (c_a + 0.1)/0.33).
/// m: 1 at the surface and 0 in the depth. q: of the tensor of the surface's normals around the particle, the
/// largest one m; half as much across a surface as along it puts curved surfaces in the right place, to first
/// order. c: variances of the particles around it over those inside a body; what is thinner than a
/// half-space, a sheet or a thread, has kernels that are thinner still, and a lone particle a round one. The
/// centres move along the normal by twice the height that the surface, smoothed over 3.6 sigma with weights
/// to which planes and quadrics are smooth already, has over its own, at most 0.16 sigma, in two passes. See
/// docs/kernels.md. threshold: T of the field [-].
KernelShapes kernel_shapes(const FieldParticles& particles, double threshold);

}  // namespace kappaflow
