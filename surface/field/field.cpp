#include "surface/field/field.h"

#include "core/parallel.h"

namespace kappaflow {

void Field::sample(SampledField& samples) const {
  const std::size_t nx = samples.dims[0], ny = samples.dims[1], nz = samples.dims[2];
  samples.value.resize(nx * ny * nz);
  constexpr std::size_t kRowsPerTask = 8;
  parallel_for(
      ny * nz,
      [&](std::size_t row) {
        const std::size_t j = row % ny, k = row / ny;
        for (std::size_t i = 0; i < nx; ++i) {
          const Vec3 x =
              samples.origin + samples.spacing * Vec3(samples.first_column + static_cast<double>(i),
                                                      samples.first_row + static_cast<double>(j),
                                                      samples.first_plane + static_cast<double>(k));
          samples.value[row * nx + i] = static_cast<float>(value_and_gradient(x).f);
        }
      },
      kRowsPerTask);
}

}  // namespace kappaflow
