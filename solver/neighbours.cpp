#include "solver/neighbours.h"

#include <array>
#include <cmath>

#include "core/parallel.h"
#include "solver/viscosity.h"

namespace kappaflow {
namespace {

constexpr std::size_t kBatch = 64;  // pairs that a vectorised loop works on at a time

/// Writes to `out` the points of [begin, end) within sqrt(square) of the point `i`, without `i`; returns the
/// end of what it wrote. `out` has room for all of them.
std::uint32_t* write_near(const float* x, const float* y, const float* z, std::size_t i, std::size_t begin,
                          std::size_t end, float square, std::uint32_t* out) {
  const float xi = x[i], yi = y[i], zi = z[i];
  std::array<float, kBatch> distance;
  for (std::size_t first = begin; first < end; first += kBatch) {
    const std::size_t count = std::min(kBatch, end - first);
    const float *px = x + first, *py = y + first, *pz = z + first;
#pragma omp simd
    for (std::size_t k = 0; k < count; ++k) {
      const float dx = px[k] - xi, dy = py[k] - yi, dz = pz[k] - zi;
      distance[k] = dx * dx + dy * dy + dz * dz;
    }
    if (i - first < count) distance[i - first] = square;  // i itself is no neighbour
    for (std::size_t k = 0; k < count; ++k) {
      *out = static_cast<std::uint32_t>(first + k);
      out += distance[k] < square;
    }
  }
  return out;
}

}  // namespace

template <class T>
void NeighbourSearch::permute(std::vector<T>& array, std::vector<T>& buffer) const {
  buffer.resize(array.size());
  const auto order = grid_.order();
  parallel_for(
      array.size(), [&](std::size_t i) { buffer[i] = array[order[i]]; }, 4096);
  array.swap(buffer);
}

void NeighbourSearch::sort(FluidParticles& particles) {
  grid_.build(std::span<const Vec4f>(particles.position), kernel_.support());
  permute(particles.id, id_buffer_);
  for (auto* array : {&particles.position, &particles.velocity, &particles.viscous_change})
    permute(*array, vector_buffer_);
  for (auto* array : {&particles.density_pressure, &particles.divergence_pressure})
    permute(*array, scalar_buffer_);
  for (auto* array : {&particles.fluid, &particles.led_by}) permute(*array, byte_buffer_);
}

std::size_t NeighbourSearch::find_in_chunk(std::size_t chunk, std::span<const Vec4f> position,
                                           NeighbourLists& lists) {
  const std::size_t end = std::min((chunk + 1) * kChunk, position.size());
  const float support = kernel_.support();
  auto& found = found_[chunk];
  std::size_t count = 0;
  for (std::size_t i = chunk * kChunk; i < end; ++i) {
    lists.begin[i] = count;  // within the chunk, for now
    grid_.ranges_near(position[i], support, [&](std::uint32_t first, std::uint32_t last) {
      if (found.size() < count + (last - first)) found.resize(2 * (count + (last - first)));
      const std::uint32_t* written = write_near(x_.data(), y_.data(), z_.data(), i, first, last,
                                                support * support, found.data() + count);
      count = static_cast<std::size_t>(written - found.data());
    });
  }
  return count;
}

void NeighbourSearch::evaluate(std::size_t i, FluidParticles& particles, NeighbourLists& lists) const {
  const Vec4f xi = particles.position[i];
  const float support = kernel_.support();
  float density = kernel_.value(0), square_sum = 0;
  Vec4f sum = Vec4f::Zero();
  std::array<float, kBatch> r2, factor, value, viscosity;
  for (std::size_t first = lists.begin[i]; first < lists.begin[i + 1]; first += kBatch) {
    const std::size_t count = std::min(kBatch, lists.begin[i + 1] - first);
    const std::uint32_t* index = lists.index.data() + first;
    Vec4f* gradient = lists.gradient.data() + first;
    for (std::size_t k = 0; k < count; ++k) {
      gradient[k] = xi - particles.position[index[k]];
      r2[k] = gradient[k].squaredNorm();
    }
#pragma omp simd reduction(+ : density, square_sum)
    for (std::size_t k = 0; k < count; ++k) {
      const float r = std::sqrt(r2[k]);
      factor[k] = volume_ * kernel_.gradient_factor(r);
      value[k] = kernel_.value(r);
      viscosity[k] = viscosity_coefficient(r2[k], factor[k], support);
      density += value[k];
      square_sum += factor[k] * factor[k] * r2[k];
    }
    for (std::size_t k = 0; k < count; ++k) {
      gradient[k] *= factor[k];
      sum += gradient[k];
      gradient[k][3] = viscosity[k];
    }
  }
  particles.density[i] = volume_ * density;
  particles.gradient_sum[i] = sum;
  particles.gradient_square_sum[i] = square_sum;
}

void NeighbourSearch::find(FluidParticles& particles, NeighbourLists& lists) {
  const std::size_t n = particles.size(), chunks = (n + kChunk - 1) / kChunk;
  for (auto* axis : {&x_, &y_, &z_}) axis->resize(n);
  for (auto* array : {&particles.density, &particles.gradient_square_sum}) array->resize(n);
  particles.gradient_sum.resize(n);
  lists.begin.resize(n + 1);
  found_.resize(std::max(chunks, found_.size()));
  found_count_.resize(chunks);
  for (std::size_t i = 0; i < n; ++i) {
    x_[i] = particles.position[i][0];
    y_[i] = particles.position[i][1];
    z_[i] = particles.position[i][2];
  }
  parallel_for(
      chunks,
      [&](std::size_t chunk) { found_count_[chunk] = find_in_chunk(chunk, particles.position, lists); }, 1);

  std::size_t pairs = 0;
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
    const std::size_t end = std::min((chunk + 1) * kChunk, n);
    for (std::size_t i = chunk * kChunk; i < end; ++i) lists.begin[i] += pairs;
    pairs += found_count_[chunk];
  }
  lists.begin[n] = pairs;
  lists.index.resize(pairs);
  lists.gradient.resize(pairs);
  parallel_for(
      chunks,
      [&](std::size_t chunk) {
        std::copy_n(found_[chunk].begin(), found_count_[chunk],
                    lists.index.begin() + static_cast<std::ptrdiff_t>(lists.begin[chunk * kChunk]));
        const std::size_t end = std::min((chunk + 1) * kChunk, n);
        for (std::size_t i = chunk * kChunk; i < end; ++i) evaluate(i, particles, lists);
      },
      1);
}

}  // namespace kappaflow
