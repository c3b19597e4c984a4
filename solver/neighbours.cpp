#include "solver/neighbours.h"

#include <atomic>
#include <bit>
#include <limits>

#include "core/errors.h"
#include "core/parallel.h"
#include "solver/halo.h"
#include "solver/lanes.h"

namespace kappaflow {
namespace {

constexpr std::uint32_t kLargestOffset = std::numeric_limits<std::uint16_t>::max();  // within a block
constexpr std::array<std::uint16_t, kWide> kInOrder{0, 1, 2, 3, 4, 5, 6, 7};

/// Squared distance of eight points from a box.
Wide square_outside(const WideVec& p, const Vec4f& lower, const Vec4f& upper) {
  const auto along = [&](const Wide& x, int axis) -> Wide {
    return (lower[axis] - x).max(x - upper[axis]).max(0.0f);
  };
  return along(p.x, 0).square() + along(p.y, 1).square() + along(p.z, 2).square();
}

}  // namespace

NeighbourSearch::NeighbourSearch(float spacing)
    : kernel_(2 * spacing),
      volume_(spacing * spacing * spacing),
      unit_(volume_ * kernel_.largest_gradient_factor() / 65535) {}

/// Lists the particles within the support of the box around the particles [begin, end) of a cell.
void NeighbourSearch::Scratch::collect(const CellGrid& grid, std::size_t begin, std::size_t end,
                                       const FluidParticles& particles, float support) {
  const std::vector<Vec4f>& position = particles.position;
  constexpr float kBoundless = std::numeric_limits<float>::infinity();
  Vec4f lower = position[begin], upper = lower;
  for (std::size_t i = begin + 1; i < end; ++i) {
    lower = lower.cwiseMin(position[i]);
    upper = upper.cwiseMax(position[i]);
  }
  lower[3] = -kBoundless, upper[3] = kBoundless;  // the fourth component is no coordinate
  std::size_t count = 0;
  const auto add = [&](std::uint32_t first, std::uint32_t last) {
    const std::size_t room = count + (last - first) + kWide;
    if (candidate.size() < room) {
      for (auto* axis : {&x, &y, &z}) axis->resize(2 * room);
      candidate.resize(2 * room);
    }
    std::uint32_t k = first;
    for (; k + kWide <= last; k += kWide) {
      const WideVec p = gather(&position[k], kInOrder.data());
      const unsigned lanes = lanes_of(eight_of(square_outside(p, lower, upper)) < support * support);
      pack(eight_of(p.x), lanes, &x[count]);
      pack(eight_of(p.y), lanes, &y[count]);
      pack(eight_of(p.z), lanes, &z[count]);
      pack(indices_from(k), lanes, &candidate[count]);
      count += static_cast<std::size_t>(std::popcount(lanes));
    }
    for (; k < last; ++k) {
      const Vec4f& p = position[k];
      x[count] = p[0], y[count] = p[1], z[count] = p[2], candidate[count] = k;
      const Vec4f outside = (lower - p).cwiseMax(p - upper).cwiseMax(0.0f);
      count += outside.squaredNorm() < support * support;
    }
  };
  grid.ranges_around(grid.cell_at(begin), add);
  if (particles.halo != nullptr) {  // behind the others, so that the candidates ascend
    const auto own = static_cast<std::uint32_t>(particles.size());
    const float reach = 0.5f * (upper - lower).head<3>().maxCoeff() + 1.01f * support;
    particles.halo->ghosts().ranges_near(
        Vec4f(0.5f * (lower + upper)), static_cast<double>(reach),
        [&](std::uint32_t first, std::uint32_t last) { add(own + first, own + last); });
  }
  candidates = (count + kWide - 1) / kWide * kWide;
  for (; count < candidates; ++count) x[count] = y[count] = z[count] = kBoundless;
}

/// Finds particle i's neighbours among them.
void NeighbourSearch::Scratch::append_row(std::uint32_t i, const Vec4f& xi, float support) {
  // Each neighbour may need a block of its own: where 2^16 particles or more lie between them.
  if (const std::size_t room = pairs + kWide * candidates; found.size() < room) {
    found.resize(2 * room);
    square.resize(found.size());
  }
  std::size_t end = pairs;
  using Loaded = Eigen::Map<const Wide>;
  for (std::size_t k = 0; k < candidates; k += kWide) {
    const Wide dx = Loaded(&x[k]) - xi[0], dy = Loaded(&y[k]) - xi[1], dz = Loaded(&z[k]) - xi[2];
    const Wide r2 = dx * dx + dy * dy + dz * dz;
    end += static_cast<std::size_t>(
        pack_below(r2, &candidate[k], support * support, i, &square[end], &found[end]));
  }
  pad_row(pairs, end, support);
}

/// Pads what was found to whole blocks, each of which spans less than 2^16 particles.
void NeighbourSearch::Scratch::pad_row(std::size_t begin, std::size_t end, float support) {
  if (begin != end && found[end - 1] - found[begin] > kLargestOffset) end = cut_row(begin, end, support);
  for (; end % kWide != 0; ++end) found[end] = found[end / kWide * kWide], square[end] = support * support;
  rows.push_back(
      {static_cast<std::uint32_t>(begin / kWide), static_cast<std::uint32_t>((end - begin) / kWide)});
  pairs = end;
}

/// Pads where a block would span more; returns the row's new end.
std::size_t NeighbourSearch::Scratch::cut_row(std::size_t begin, std::size_t end, float support) {
  row.assign(found.begin() + static_cast<std::ptrdiff_t>(begin),
             found.begin() + static_cast<std::ptrdiff_t>(end));
  row_square.assign(square.begin() + static_cast<std::ptrdiff_t>(begin),
                    square.begin() + static_cast<std::ptrdiff_t>(end));
  std::size_t at = begin;
  std::uint32_t base = row.front();
  for (std::size_t k = 0; k < row.size(); ++k) {
    if (row[k] - base > kLargestOffset)
      for (; at % kWide != 0; ++at) found[at] = base, square[at] = support * support;
    if (at % kWide == 0) base = row[k];
    found[at] = row[k], square[at] = row_square[k];
    ++at;
  }
  return at;
}

template <class T>
void NeighbourSearch::permute(std::vector<T>& array, std::vector<T>& buffer) const {
  buffer.resize(array.size());
  const auto order = grid_.order();
  parallel_for(
      array.size(), [&](std::size_t i) { buffer[i] = array[order[i]]; }, 4096);
  array.swap(buffer);
}

template <class T, class Wider, class Widen, class Narrow>
void NeighbourSearch::permute_in_wider(std::vector<T>& array, std::vector<Wider>& buffer, const Widen& widen,
                                       const Narrow& narrow) const {
  buffer.resize(array.size());
  const auto order = grid_.order();
  parallel_for(
      array.size(), [&](std::size_t i) { buffer[i] = widen(array[order[i]]); }, 4096);
  parallel_for(
      array.size(), [&](std::size_t i) { array[i] = narrow(buffer[i]); }, 4096);
}

void NeighbourSearch::sort(FluidParticles& particles) {
  grid_.build(std::span<const Vec4f>(particles.position), kernel_.support());
  permute(particles.id, id_buffer_);
  permute(particles.temperature, temperature_buffer_);
  for (auto* array : {&particles.position, &particles.velocity, &particles.viscous_velocity})
    permute(*array, particles.scratch[0]);
  permute_in_wider(
      particles.viscous_acceleration, particles.scratch[0], [](const Vec4h& a) { return widened(a); },
      [](const Vec4f& a) { return halved(a); });
  for (auto* array : {&particles.density_pressure, &particles.divergence_pressure, &particles.least_pressure})
    permute(*array, particles.scalar_scratch);
  for (auto* array : {&particles.fluid, &particles.led_by})
    permute_in_wider(
        *array, id_buffer_, [](std::uint8_t byte) -> std::uint32_t { return byte; },
        [](std::uint32_t byte) { return static_cast<std::uint8_t>(byte); });
  permute_in_wider(
      particles.source, id_buffer_, [](int number) { return static_cast<std::uint32_t>(number); },
      [](std::uint32_t number) { return static_cast<int>(number); });
}

void NeighbourSearch::find_in_chunk(std::size_t chunk, const FluidParticles& particles,
                                    Scratch& scratch) const {
  const std::size_t begin = chunk * kChunk, end = std::min(begin + kChunk, particles.size());
  scratch.rows.clear();
  scratch.pairs = 0;
  for (std::size_t i = begin, in_cell = begin; i < end; ++i) {
    if (i == in_cell) {
      while (in_cell < end && grid_.cell_at(in_cell) == grid_.cell_at(i)) ++in_cell;
      scratch.collect(grid_, i, in_cell, particles, kernel_.support());
    }
    scratch.append_row(static_cast<std::uint32_t>(i), particles.position[i], kernel_.support());
  }
}

void NeighbourSearch::evaluate(std::size_t i, FluidParticles& particles, std::span<const float> square,
                               std::span<const std::uint32_t> found, std::span<PairBlock> blocks) const {
  const Vec4f xi = particles.position[i];
  Wide density = Wide::Zero(), square_sum = Wide::Zero();
  Wide sum_x = Wide::Zero(), sum_y = Wide::Zero(), sum_z = Wide::Zero();
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const Wide r2 = Eigen::Map<const Wide>(&square[kWide * b]);
    const Wide r = r2.sqrt();
    density += kernel_.value(r);
    PairBlock& block = blocks[b];
    block.base = found[kWide * b];
    for (std::size_t k = 0; k < kWide; ++k)
      block.offset[k] = static_cast<std::uint16_t>(found[kWide * b + k] - block.base);
    const Wide rounded = kernel_.gradient_factor(r) * (volume_ / -unit_) + 0.5f;
    narrow((r2 < kernel_.support() * kernel_.support()).select(rounded.max(1.0f), 0.0f), block.factor.data());
    const Wide factor = -unit_ * widen(block.factor.data());
    const WideVec xj = gather(particles.position, block);
    if (particles.masses_differ())
      square_sum += factor * factor * r2 / masses(particles, block);
    else
      square_sum += factor * factor * r2;
    sum_x += factor * (xi[0] - xj.x);
    sum_y += factor * (xi[1] - xj.y);
    sum_z += factor * (xi[2] - xj.z);
  }
  particles.density[i] = volume_ * (kernel_.value(0) + density.sum());
  particles.gradient_sum[i] = sums(sum_x, sum_y, sum_z);
  particles.gradient_square_sum[i] = square_sum.sum();
}

void NeighbourSearch::find(FluidParticles& particles, NeighbourLists& lists) {
  const std::size_t n = particles.size();
  for (auto* array : {&particles.density, &particles.gradient_square_sum}) array->resize(n);
  particles.gradient_sum.resize(n);
  lists.rows.resize(n);
  lists.unit = unit_;
  // Each chunk takes its room in the lists as it comes: where a row lies depends on the threads, what stands
  // in it does not.
  std::size_t needed = 0;
  while ((needed = fill(particles, lists)) > lists.blocks.size()) {
    std::vector<PairBlock>().swap(lists.blocks);  // first: never the old room and the new one at once
    lists.blocks = std::vector<PairBlock>(needed + needed / kHeadroom);
  }
  if (particles.halo != nullptr) particles.halo->find_beside(lists);
}

std::size_t NeighbourSearch::fill(FluidParticles& particles, NeighbourLists& lists) {
  std::atomic<std::size_t> needed = 0;
  parallel_for((particles.size() + kChunk - 1) / kChunk,
               [&](std::size_t chunk) {
                 Scratch& scratch = scratch_.local();
                 find_in_chunk(chunk, particles, scratch);
                 const std::size_t count = scratch.pairs / kWide, first = needed.fetch_add(count);
                 if (first + count > lists.blocks.size()) return;
                 for (std::size_t k = 0; k < scratch.rows.size(); ++k) {
                   const auto [begin, count_of_row] = scratch.rows[k];
                   const std::size_t i = chunk * kChunk + k;
                   lists.rows[i] = {static_cast<std::uint32_t>(first) + begin, count_of_row};
                   evaluate(i, particles, std::span(scratch.square).subspan(kWide * begin),
                            std::span(scratch.found).subspan(kWide * begin),
                            std::span(lists.blocks).subspan(first + begin, count_of_row));
                 }
               },
               1);
  if (needed > std::numeric_limits<std::uint32_t>::max())
    throw InvalidInput("fluid: one process holds at most some 5e8 particles; several share them (mpirun)");
  return needed;
}

}  // namespace kappaflow
