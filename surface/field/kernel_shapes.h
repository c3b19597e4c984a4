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

/// The support radius that suits kernels [particle spacings]: anisotropic ones have few waves left at 2.5.
constexpr double usual_sigma(Kernels kernels) {
  return kernels == Kernels::round ? 2 : 2.5;
}

/// How each particle's kernel differs from the round one. One entry a particle.
struct KernelShapes {
  std::vector<Vec3> offset;            ///< c_i - x_i [m]
  std::vector<SymmetricMatrix> shape;  ///< M_i [1/m2]
  std::vector<double> weight;          ///< w_i of the kernel: its integral is that of the round one [-]

  std::size_t size() const { return offset.size(); }
};

/// Kernels after Yu & Turk (2013), "Reconstructing surfaces of particle-based fluids using anisotropic
/// kernels", that keep the volume: M^-1 = sigma^2 S, where S has the eigenvalues
///   s_a = 1 + (l - 1) m - l q_a/2.
/// m: 1 at the surface and 0 in the depth. q: of the tensor of the surface's normals around the particle, the
/// largest one m. l: 1.5^2 on flat surfaces, 1 where the second of the normals' eigenvalues is half of the
/// largest: at creases kernels stay short. Half as much across a surface as along it puts curved surfaces in
/// the right place, to first order. Where the particles around vary little along an axis, they are a sheet,
/// or a thread where along two: across it s = (1.25 d)^2 - 2.25 c, with d the thickness that the sum of round
/// kernels tells [sigma] and c the variance over that of the inside, and the weight puts the surface d/2 from
/// the middle; but for d < 0.33, where particles would make holes. A particle that has no others near keeps
/// its round kernel. The centres move along the normal by twice the height that the surface, smoothed
/// over 3.6 sigma with weights to which planes and quadrics are smooth already, has over its own, in three
/// passes, at most 0.2 sigma. See docs/kernels.md. threshold: T of the field [-]. Throws InvalidInput as
/// check_field_particles() does, and unless threshold > 0.
KernelShapes kernel_shapes(const FieldParticles& particles, double threshold);

}  // namespace kappaflow
