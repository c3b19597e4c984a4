#include "surface/topology/winding_numbers.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "core/sort_unique.h"
#include "core/whole_within.h"
#include "surface/mesh/lattice_blocks.h"

namespace kappaflow {
namespace {

constexpr int kTube = 8;                    // rows of a tube, in y and in z: few triangles reach into two
constexpr std::size_t kChunk = 4096;        // triangles of a task
constexpr int kBeyondLattice = 1 << 30;     // more points than one has along an axis
const Vec3 kRowShift(0, 1.37e-7, 2.91e-7);  // [spacings] of the rows: patches have vertices on the lattice's

/// Ascending by z, then by y.
std::uint64_t tube_number(int y, int z) {
  return static_cast<std::uint64_t>(z) << 32 | static_cast<std::uint64_t>(y);
}
int y_of(std::uint64_t tube) {
  return static_cast<int>(tube & 0xffffffffu);
}
int z_of(std::uint64_t tube) {
  return static_cast<int>(tube >> 32);
}
int row_in_tube(int j, int k) {
  return k % kTube * kTube + j % kTube;
}

/// Twice the area of (a, b, p) projected on the y-z plane, positive counter-clockwise. The same number, but
/// for its sign, from both triangles at an edge.
double turn(const Vec3& a, const Vec3& b, int number_a, int number_b, double y, double z) {
  if (number_a > number_b) return -turn(b, a, number_b, number_a, y, z);
  return (b[1] - a[1]) * (z - a[2]) - (b[2] - a[2]) * (y - a[1]);
}

/// The first lattice point along an axis from x on, not before `least`; and the last one up to x.
int first_from(double x, int least) {
  return whole_within(std::ceil(x), least, kBeyondLattice);
}
int last_to(double x, int most) {
  return whole_within(std::floor(x), -kBeyondLattice, most);
}

}  // namespace

WindingNumbers::WindingNumbers(std::span<const Vec3> position, std::span<const Triangle> triangles,
                               const SampledField& lattice, std::span<const LatticeBlock> blocks) {
  find_tubes(blocks);
  const auto in_lattice = [&](int v) -> Vec3 {
    return (position[v] - lattice.origin) / lattice.spacing - kRowShift;
  };
  std::vector<std::vector<Crossing>> found((triangles.size() + kChunk - 1) / kChunk);
  parallel_for(
      found.size(),
      [&](std::size_t chunk) {
        const std::size_t end = std::min(triangles.size(), (chunk + 1) * kChunk);
        for (std::size_t t = chunk * kChunk; t < end; ++t) {
          const auto& [a, b, c] = triangles[t];
          cross_rows({in_lattice(a), in_lattice(b), in_lattice(c)}, triangles[t], found[chunk]);
        }
      },
      1);
  sort_by_row(found);
}

void WindingNumbers::find_tubes(std::span<const LatticeBlock> blocks) {
  for (const LatticeBlock& block : blocks) {
    for (int a = 0; a < 3; ++a) all_.last[a] = std::max(all_.last[a], block.last[a]);
    for (int z = block.first[2] / kTube; z <= block.last[2] / kTube; ++z)
      for (int y = block.first[1] / kTube; y <= block.last[1] / kTube; ++y)
        tubes_.push_back(tube_number(y, z));
  }
  sort_unique(tubes_);
}

/// corner: in spacings of the lattice.
void WindingNumbers::cross_rows(const std::array<Vec3, 3>& corner, const Triangle& number,
                                std::vector<Crossing>& found) const {
  const auto [z_least, z_most] = std::minmax({corner[0][2], corner[1][2], corner[2][2]});
  const int k_begin = first_from(z_least, 0), k_end = last_to(z_most, all_.last[2]);
  const auto [y_least, y_most] = std::minmax({corner[0][1], corner[1][1], corner[2][1]});
  const int j_begin = first_from(y_least, 0), j_end = last_to(y_most, all_.last[1]);
  if (k_begin > k_end || j_begin > j_end) return;
  const int y_first = j_begin / kTube, y_last = j_end / kTube;
  auto tube = std::ranges::lower_bound(tubes_, tube_number(y_first, k_begin / kTube));
  while (tube != tubes_.end() && z_of(*tube) <= k_end / kTube) {
    const int y = y_of(*tube), z = z_of(*tube);
    if (y < y_first || y > y_last) {  // on to the next one that the triangle may reach into
      tube = std::lower_bound(tube, tubes_.end(), tube_number(y_first, y < y_first ? z : z + 1));
      continue;
    }
    const auto row = static_cast<std::uint32_t>(kTube * kTube * (tube - tubes_.begin()));
    for (int k = std::max(k_begin, z * kTube); k <= std::min(k_end, z * kTube + kTube - 1); ++k)
      for (int j = std::max(j_begin, y * kTube); j <= std::min(j_end, y * kTube + kTube - 1); ++j)
        cross_row(corner, number, j, k, row + row_in_tube(j, k), found);
    ++tube;
  }
}

/// The row at y = j and z = k.
void WindingNumbers::cross_row(const std::array<Vec3, 3>& corner, const Triangle& number, int j, int k,
                               std::uint32_t row, std::vector<Crossing>& found) const {
  Vec3 share;  // of the corner opposite to each edge, times twice the area
  for (int c = 0; c < 3; ++c) {
    const int p = (c + 1) % 3, q = (c + 2) % 3;
    share[c] = turn(corner[p], corner[q], number[p], number[q], j, k);
  }
  if (!(share.minCoeff() > 0) && !(share.maxCoeff() < 0)) return;
  const double x =
      (share[0] * corner[0][0] + share[1] * corner[1][0] + share[2] * corner[2][0]) / share.sum();
  const int column = first_from(x, 0);
  // A triangle that turns counter-clockwise looks towards +x: beyond it is outside.
  if (column <= all_.last[0]) found.push_back({row, column, static_cast<std::int8_t>(share[0] > 0 ? -1 : 1)});
}

void WindingNumbers::sort_by_row(std::span<const std::vector<Crossing>> found) {
  start_.assign(tubes_.size() * kTube * kTube + 1, 0);
  for (const std::vector<Crossing>& of_chunk : found)
    for (const Crossing& crossing : of_chunk) ++start_[crossing.row];
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  crossings_.resize(start_.back());
  for (const std::vector<Crossing>& of_chunk : found)  // moves each start from its end to its begin
    for (const Crossing& crossing : of_chunk) crossings_[--start_[crossing.row]] = crossing;
}

std::span<const WindingNumbers::Crossing> WindingNumbers::in_row(int j, int k) const {
  const auto tube = std::ranges::lower_bound(tubes_, tube_number(j / kTube, k / kTube));
  const std::size_t row = kTube * kTube * (tube - tubes_.begin()) + row_in_tube(j, k);
  return std::span(crossings_).subspan(start_[row], start_[row + 1] - start_[row]);
}

std::vector<std::int8_t> WindingNumbers::in(const SampledField& part) const {
  const int columns = part.dims[0], rows = part.dims[1];
  std::vector<std::int8_t> winding(static_cast<std::size_t>(columns) * rows * part.dims[2], 0);
  parallel_for(static_cast<std::size_t>(rows) * part.dims[2], [&](std::size_t jk) {
    const auto crossings =
        in_row(part.first_row + static_cast<int>(jk % rows), part.first_plane + static_cast<int>(jk / rows));
    if (crossings.empty()) return;
    const std::span row = std::span(winding).subspan(jk * columns, columns);
    for (const Crossing& crossing : crossings) {
      const int i = std::max(0, crossing.column - part.first_column);
      if (i < columns) row[i] = static_cast<std::int8_t>(row[i] + crossing.step);
    }
    for (int i = 1; i < columns; ++i) row[i] = static_cast<std::int8_t>(row[i] + row[i - 1]);
  });
  return winding;
}

TriangleMesh seen_by_lattice(const TriangleMesh& mesh, const SampledField& lattice) {
  const std::vector<LatticeBlock> blocks =
      blocks_of(lattice, cubes_of(lattice, mesh.position, mesh.triangles));
  const WindingNumbers numbers(mesh.position, mesh.triangles, lattice, blocks);
  return extract_isosurface(lattice, blocks, [&](SampledField& samples) {
    const std::vector<std::int8_t> winding = numbers.in(samples);
    samples.value.resize(winding.size());
    std::ranges::transform(winding, samples.value.begin(), [](int n) { return n != 0 ? 1.0f : -1.0f; });
  });
}

}  // namespace kappaflow
