#include "surface/topology/winding_numbers.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/whole_within.h"
#include "surface/mesh/lattice_blocks.h"

namespace kappaflow {
namespace {

constexpr int kWindingPlanes = 8;           // of a task: most triangles reach into one or two
constexpr int kBeyondLattice = 1 << 30;     // more points than one has along an axis
constexpr double kRowsAround = 0.01;        // [spacings] rows are shifted by less
const Vec3 kRowShift(0, 1.37e-7, 2.91e-7);  // [spacings] of the rows: patches have vertices on the lattice's

/// Twice the area of (a, b, p) projected on the y-z plane, positive counter-clockwise. The same number, but
/// for its sign, from both triangles at an edge.
double turn(const Vec3& a, const Vec3& b, int number_a, int number_b, double y, double z) {
  if (number_a > number_b) return -turn(b, a, number_b, number_a, y, z);
  return (b[1] - a[1]) * (z - a[2]) - (b[2] - a[2]) * (y - a[1]);
}

/// The triangles that reach into each slab of the lattice, ascending. plane_of(v): of a vertex, in spacings.
template <class PlaneOf>
std::vector<std::vector<int>> by_slab(std::span<const Triangle> triangles, int planes,
                                      const PlaneOf& plane_of) {
  const int slabs = (planes + kWindingPlanes - 1) / kWindingPlanes;
  std::vector<std::vector<int>> result(slabs);
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    const auto& [a, b, c] = triangles[t];
    const auto [least, most] = std::minmax({plane_of(a), plane_of(b), plane_of(c)});
    const double last = std::min<double>(std::floor(most / kWindingPlanes), slabs - 1);
    for (double s = std::max(0.0, std::floor(least / kWindingPlanes)); s <= last; ++s)
      result[static_cast<std::size_t>(s)].push_back(t);
  }
  return result;
}

/// Counts crossings on planes first to last of the lattice.
class WindingSlab {
 public:
  WindingSlab(const SampledField& lattice, int first, int last, std::int8_t* winding)
      : nx_(lattice.dims[0]), ny_(lattice.dims[1]), first_(first), last_(last), winding_(winding) {}

  void add(const std::array<Vec3, 3>& corner, const Triangle& number) {
    const auto [z_least, z_most] = std::minmax({corner[0][2], corner[1][2], corner[2][2]});
    const int k_begin = first_from(z_least, first_), k_end = last_to(z_most, last_);
    if (k_begin > k_end) return;
    const auto [y_least, y_most] = std::minmax({corner[0][1], corner[1][1], corner[2][1]});
    const int j_begin = first_from(y_least, 0), j_end = last_to(y_most, ny_ - 1);
    for (int k = k_begin; k <= k_end; ++k)
      for (int j = j_begin; j <= j_end; ++j) add_crossing(corner, number, j, k);
  }

  /// From crossings to winding numbers.
  void sum_up() {
    for (int k = first_; k <= last_; ++k)
      for (int j = 0; j < ny_; ++j) {
        std::int8_t* const row = row_of(j, k);
        for (int i = 1; i < nx_; ++i) row[i] = static_cast<std::int8_t>(row[i] + row[i - 1]);
      }
  }

 private:
  static int first_from(double x, int least) { return whole_within(std::ceil(x), least, kBeyondLattice); }
  static int last_to(double x, int most) { return whole_within(std::floor(x), -kBeyondLattice, most); }
  std::int8_t* row_of(int j, int k) {
    return winding_ + (static_cast<std::size_t>(k) * ny_ + j) * static_cast<std::size_t>(nx_);
  }

  void add_crossing(const std::array<Vec3, 3>& corner, const Triangle& number, int j, int k) {
    Vec3 share;  // of the corner opposite to each edge, times twice the area
    for (int c = 0; c < 3; ++c) {
      const int p = (c + 1) % 3, q = (c + 2) % 3;
      share[c] = turn(corner[p], corner[q], number[p], number[q], j, k);
    }
    if (!(share.minCoeff() > 0) && !(share.maxCoeff() < 0)) return;
    const double x =
        (share[0] * corner[0][0] + share[1] * corner[1][0] + share[2] * corner[2][0]) / share.sum();
    const int i = first_from(x, 0);
    // A triangle that turns counter-clockwise looks towards +x: beyond it is outside.
    if (i < nx_) row_of(j, k)[i] = static_cast<std::int8_t>(row_of(j, k)[i] + (share[0] > 0 ? -1 : 1));
  }

  int nx_, ny_, first_, last_;
  std::int8_t* winding_;
};

}  // namespace

std::vector<std::int8_t> winding_numbers(std::span<const Vec3> position, std::span<const Triangle> triangles,
                                         const SampledField& lattice) {
  const auto& dims = lattice.dims;
  std::vector<std::int8_t> winding(static_cast<std::size_t>(dims[0]) * dims[1] * dims[2], 0);
  const Vec3 offset = Vec3(lattice.first_column, lattice.first_row, lattice.first_plane) + kRowShift;
  const auto in_lattice = [&](int v) -> Vec3 {
    return (position[v] - lattice.origin) / lattice.spacing - offset;
  };
  const std::vector<std::vector<int>> in_slab =
      by_slab(triangles, dims[2], [&](int v) { return in_lattice(v)[2]; });
  parallel_for(
      in_slab.size(),
      [&](std::size_t s) {
        const int first = static_cast<int>(s) * kWindingPlanes;
        WindingSlab slab(lattice, first, std::min(first + kWindingPlanes, dims[2]) - 1, winding.data());
        for (const int t : in_slab[s]) {
          const auto& [a, b, c] = triangles[t];
          slab.add({in_lattice(a), in_lattice(b), in_lattice(c)}, triangles[t]);
        }
        slab.sum_up();
      },
      1);
  return winding;
}

TriangleMesh seen_by_lattice(const TriangleMesh& mesh, const SampledField& lattice) {
  const std::vector<LatticeBlock> blocks =
      blocks_of(lattice, cubes_of(lattice, mesh.position, mesh.triangles));
  const auto near = triangles_in_rows(lattice, mesh.position, mesh.triangles, blocks, kRowsAround);
  std::size_t block = 0;
  return extract_isosurface(lattice, blocks, [&](SampledField& samples) {
    const std::vector<std::int8_t> winding =
        winding_numbers(mesh.position, blocks.size() == 1 ? near[0] : near[block++], samples);
    samples.value.resize(winding.size());
    std::ranges::transform(winding, samples.value.begin(), [](int n) { return n != 0 ? 1.0f : -1.0f; });
  });
}

}  // namespace kappaflow
