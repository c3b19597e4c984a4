#include "surface/topology/disagreement.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>

#include "core/nearest_on_triangle.h"
#include "core/shared_loop.h"
#include "core/triangle_geometry.h"
#include "core/whole_within.h"
#include "surface/field/projection.h"
#include "surface/mesh/lattice_blocks.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/topology/simple_points.h"
#include "surface/topology/winding_numbers.h"

namespace kappaflow {
namespace {

constexpr double kFacing = 0.9;                              // cosine to the sum of the corners' normals
constexpr double kParallel = 2.7;                            // length of that sum
constexpr double kAgreeing = 1;                              // such length below which it says nothing
constexpr double kOverlongEdge = 8;                          // in limits
constexpr std::size_t kPointsAtOnce = std::size_t{1} << 22;  // of the lattice, in memory of each thread
constexpr int kOverlap = 4;                                  // of slabs and blocks of it, in points

/// Whether the field is not to be asked: the triangle is small and all that is known at its corners, which
/// are on the surface, fits.
bool is_plainly_on_surface(std::span<const Vec3> position, std::span<const Vec3> gradient,
                           const Triangle& triangle, double limit) {
  const auto& [a, b, c] = triangle;
  const Vec3 &x = position[a], &y = position[b], &z = position[c];
  const Vec3 normals = sum_of_normals(gradient, triangle);
  return longest_edge_squared(x, y, z) < kOverlongEdge * kOverlongEdge * limit * limit &&
         normals.norm() > kParallel && facing(x, y, z, normals) > kFacing;
}

/// Central differences of the samples at a point, one-sided at the lattice's rim [1/m].
Vec3 sampled_gradient(const SampledField& samples, const LatticeCell& at) {
  const std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(samples.dims[0]),
                                          static_cast<std::size_t>(samples.dims[0]) * samples.dims[1]};
  const std::size_t index = at[0] + at[1] * stride[1] + at[2] * stride[2];
  Vec3 gradient;
  for (int a = 0; a < 3; ++a) {
    const bool below = at[a] > 0, above = at[a] < samples.dims[a] - 1;
    const double difference =
        samples.value[index + (above ? stride[a] : 0)] - samples.value[index - (below ? stride[a] : 0)];
    gradient[a] = difference / (samples.spacing * (below + above));
  }
  return gradient;
}

bool is_on_rim(const std::array<int, 3>& dims, const LatticeCell& at) {
  for (int a = 0; a < 3; ++a)
    if (at[a] == 0 || at[a] == dims[a] - 1) return true;
  return false;
}

/// The 27 points around one that is not on the lattice's rim; is_inside: of a point's number.
template <class Test>
Neighbourhood around(const std::array<int, 3>& dims, const LatticeCell& at, const Test& is_inside) {
  return neighbourhood([&](int i, int j, int k) {
    return is_inside((static_cast<std::size_t>(at[2] + k) * dims[1] + at[1] + j) * dims[0] + at[0] + i);
  });
}

/// Lets the points, none on the rim, change sides, one after the other, that can without a change of
/// topology; what is left parts, joins, opens or fills something.
void deform(const std::array<int, 3>& dims, std::vector<LatticeCell>& points,
            std::vector<std::int8_t>& winding) {
  const auto inside = [&](std::size_t point) { return winding[point] != 0; };
  std::size_t before = 0;
  do {
    before = points.size();
    std::erase_if(points, [&](const LatticeCell& at) {
      if (!is_simple(around(dims, at, inside))) return false;
      std::int8_t& number = winding[(static_cast<std::size_t>(at[2]) * dims[1] + at[1]) * dims[0] + at[0]];
      number = number == 0 ? 1 : 0;
      return true;
    });
  } while (points.size() < before);
}

/// Some points of a lattice, as bits, row by row: most boxes of triangles hold none of them.
class PointSet {
 public:
  explicit PointSet(const std::array<int, 3>& dims)
      : dims_(dims), words_((dims[0] + 63) / 64), bits_(words_ * dims[1] * dims[2], 0) {}

  // Other threads may add points at the same time.
  void add(const LatticeCell& at) { word_of(at).fetch_or(bit_of(at), std::memory_order_relaxed); }
  bool has(const LatticeCell& at) { return (word_of(at).load(std::memory_order_relaxed) & bit_of(at)) != 0; }

  /// Calls visit(point) for those from `first` to `last`.
  template <class Visit>
  void for_each_in(const LatticeCell& first, const LatticeCell& last, const Visit& visit) const {
    if (first[0] > last[0]) return;
    for (int k = first[2]; k <= last[2]; ++k)
      for (int j = first[1]; j <= last[1]; ++j)
        for (int w = first[0] / 64; w <= last[0] / 64; ++w) {
          std::uint64_t bits = bits_[word(64 * w, j, k)];
          if (w == first[0] / 64) bits &= ~std::uint64_t{0} << first[0] % 64;
          if (w == last[0] / 64) bits &= ~std::uint64_t{0} >> (63 - last[0] % 64);
          for (; bits != 0; bits &= bits - 1) visit(LatticeCell{64 * w + std::countr_zero(bits), j, k});
        }
  }

 private:
  std::size_t word(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * dims_[1] + j) * words_ + i / 64;
  }
  std::atomic_ref<std::uint64_t> word_of(const LatticeCell& at) {
    return std::atomic_ref(bits_[word(at[0], at[1], at[2])]);
  }
  static std::uint64_t bit_of(const LatticeCell& at) { return std::uint64_t{1} << at[0] % 64; }

  std::array<int, 3> dims_;
  std::size_t words_;  // of a row
  std::vector<std::uint64_t> bits_;
};

/// Calls visit(point, place) for those of the samples' points in the triangle's box, widened by `reach` [m].
template <class Visit>
void for_each_near(const PointSet& points, const std::array<Vec3, 3>& corner, double reach,
                   const SampledField& samples, const Visit& visit) {
  const Vec3 origin =
      samples.origin + samples.spacing * Vec3(samples.first_column, samples.first_row, samples.first_plane);
  const Vec3 least = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]),
             most = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]);
  LatticeCell first{}, last{};
  for (int i = 0; i < 3; ++i) {
    const int end = samples.dims[i];
    first[i] = whole_within(std::ceil((least[i] - reach - origin[i]) / samples.spacing), 0, end);
    last[i] = whole_within(std::floor((most[i] + reach - origin[i]) / samples.spacing), -1, end - 1);
  }
  points.for_each_in(first, last, [&](const LatticeCell& at) {
    visit(at, Vec3(origin + samples.spacing * Vec3(at[0], at[1], at[2])));
  });
}

/// Points of the samples on which mesh and surface do not agree.
struct DisputedPoints {
  std::vector<LatticeCell> certain;
  std::vector<LatticeCell> near;  ///< near f = 0, where a good mesh's chords may be on either side

  void add(const DisputedPoints& other) {
    certain.insert(certain.end(), other.certain.begin(), other.certain.end());
    near.insert(near.end(), other.near.begin(), other.near.end());
  }
};

/// Whether the mesh may have the point on the wrong side only because its triangles are flat: f = 0 is within
/// `limit` [m], as f and its central differences tell, and the point is simple in the surface's inside.
bool is_near_surface(const SampledField& samples, const LatticeCell& at, double f, double limit) {
  return std::abs(f) <= limit * sampled_gradient(samples, at).norm() && !is_on_rim(samples.dims, at) &&
         is_simple(around(samples.dims, at, [&](std::size_t point) { return samples.value[point] > 0; }));
}

/// The points of plane k whose winding number is not what the sign of f says.
DisputedPoints disputed_in_plane(const SampledField& samples, std::span<const std::int8_t> winding, int k,
                                 double limit) {
  const auto [nx, ny, nz] = samples.dims;
  DisputedPoints found;
  for (int j = 0; j < ny; ++j) {
    const std::size_t row = (static_cast<std::size_t>(k) * ny + j) * nx;
    const auto agrees = [&](int i) { return winding[row + i] == std::int8_t{samples.value[row + i] > 0}; };
    bool all_agree = true;
    for (int i = 0; i < nx; ++i) all_agree &= agrees(i);
    for (int i = 0; i < nx && !all_agree; ++i) {
      if (agrees(i)) continue;
      const bool once = winding[row + i] == 0 || winding[row + i] == 1;
      const LatticeCell at{i, j, k};
      const bool is_near = once && is_near_surface(samples, at, samples.value[row + i], limit);
      (is_near ? found.near : found.certain).push_back(at);
    }
  }
  return found;
}

/// Moves the points further than `limit` from every triangle of the mesh, of which those near the samples
/// are given, from DisputedPoints::near to `certain`: the mesh has left a tip or a slit out that is thinner
/// than f/|g| tells.
void move_far_from_mesh(const TriangleMesh& mesh, std::span<const int> near, double limit,
                        const SampledField& samples, DisputedPoints& disputed) {
  if (disputed.near.empty()) return;
  PointSet asked(samples.dims), reached(samples.dims);
  for (const LatticeCell& at : disputed.near) asked.add(at);
  parallel_for(near.size(), [&](std::size_t n) {
    const auto& [a, b, c] = mesh.triangles[near[n]];
    const std::array<Vec3, 3> corner{mesh.position[a], mesh.position[b], mesh.position[c]};
    for_each_near(asked, corner, limit, samples, [&](const LatticeCell& at, const Vec3& x) {
      if (!reached.has(at) && (nearest_on_triangle(corner, x).point - x).norm() <= limit) reached.add(at);
    });
  });
  const auto far = std::stable_partition(disputed.near.begin(), disputed.near.end(),
                                         [&](const LatticeCell& at) { return reached.has(at); });
  disputed.certain.insert(disputed.certain.end(), far, disputed.near.end());
  disputed.near.erase(far, disputed.near.end());
}

/// The points in dispute of a part of the lattice, by their numbers in it; fills the samples. near:
/// triangles.
std::vector<LatticeCell> points_in_dispute(const Field& field, const TriangleMesh& mesh,
                                           const WindingNumbers& numbers, std::span<const int> near,
                                           double limit, SampledField& samples) {
  field.sample(samples);
  std::vector<std::int8_t> winding = numbers.in(samples);
  std::vector<DisputedPoints> in_plane(samples.dims[2]);
  parallel_for(
      in_plane.size(),
      [&](std::size_t k) { in_plane[k] = disputed_in_plane(samples, winding, static_cast<int>(k), limit); },
      1);
  DisputedPoints disputed;
  for (const DisputedPoints& plane : in_plane) disputed.add(plane);
  move_far_from_mesh(mesh, near, limit, samples, disputed);
  deform(samples.dims, disputed.near, winding);
  disputed.certain.insert(disputed.certain.end(), disputed.near.begin(), disputed.near.end());
  return disputed.certain;
}

/// The block and so many points around it, as far as the lattice has them.
LatticeBlock widened(const SampledField& lattice, LatticeBlock block, int points) {
  for (int a = 0; a < 3; ++a) {
    block.first[a] = std::max(block.first[a] - points, 0);
    block.last[a] = std::min(block.last[a] + points, lattice.dims[a] - 1);
  }
  return block;
}

/// Cuts a block across z, so that each piece has at most kPointsAtOnce points with those around it, or is
/// thin; none where it is empty.
void add_slabs(const SampledField& lattice, const LatticeBlock& block, std::vector<LatticeBlock>& slabs) {
  if (!has(block, block.first)) return;
  const auto& [first, last] = widened(lattice, block, kOverlap);
  const std::size_t plane = static_cast<std::size_t>(last[0] - first[0] + 1) * (last[1] - first[1] + 1);
  const int planes = std::max(static_cast<int>(kPointsAtOnce / plane) - 2 * kOverlap, 2 * kOverlap);
  for (int z = block.first[2]; z <= block.last[2]; z += planes) {
    LatticeBlock& slab = slabs.emplace_back(block);
    slab.first[2] = z;
    slab.last[2] = std::min(z + planes - 1, block.last[2]);
  }
}

}  // namespace

LatticeCell cell_of(const SampledField& lattice, const Vec3& x) {
  const Vec3 cell = ((x - lattice.origin) / lattice.spacing).array().floor();
  const auto index = [&](int a) { return whole_within(cell[a], -kFarthestCell, kFarthestCell); };
  return {index(0), index(1), index(2)};
}

std::vector<LatticeCell> cells_of(const SampledField& lattice, const TriangleMesh& mesh,
                                  std::span<const int> triangles) {
  std::vector<LatticeCell> cells;
  for (const int t : triangles) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3 &x = mesh.position[a], &y = mesh.position[b], &z = mesh.position[c];
    for (const Vec3& p : {x, y, z, Vec3((x + y + z) / 3)}) cells.push_back(cell_of(lattice, p));
  }
  return cells;
}

Vec3 sum_of_normals(std::span<const Vec3> gradient, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return -gradient[a].normalized() - gradient[b].normalized() - gradient[c].normalized();
}

bool normals_agree(const Vec3& sum_of_normals) {
  return sum_of_normals.norm() > kAgreeing;
}

bool is_off_surface(const Field& field, std::span<const Vec3> position, std::span<const Vec3> gradient,
                    const Triangle& triangle, double limit) {
  const auto& [a, b, c] = triangle;
  const Vec3 normals = sum_of_normals(gradient, triangle);
  if (normals_agree(normals) && !(facing(position[a], position[b], position[c], normals) > 0)) return true;
  const Vec3 centroid = (position[a] + position[b] + position[c]) / 3;
  const ValueAndGradient at = field.value_and_gradient(centroid);
  if (std::abs(at.f) <= limit * at.g.norm()) return false;
  // In the middle of a thin sheet, under its rim, the gradient vanishes and f = 0 is near all the same.
  const Projected projected = project(field, centroid, {});
  return !projected.converged || (projected.position - centroid).norm() > limit ||
         facing(position[a], position[b], position[c], -projected.gradient) < 0;
}

std::vector<int> triangles_off_surface(const Field& field, const TriangleMesh& mesh, double limit) {
  std::vector<char> off(mesh.triangles.size());
  shared_for(
      off.size(),
      [&](std::size_t t) {
        const Triangle& triangle = mesh.triangles[t];
        off[t] = std::ranges::any_of(triangle, [&](int v) { return mesh.unprojected[v] != 0; }) ||
                 (!is_plainly_on_surface(mesh.position, mesh.gradient, triangle, limit) &&
                  is_off_surface(field, mesh.position, mesh.gradient, triangle, limit));
      },
      kDefaultGrain, off);
  std::vector<int> found;
  for (int t = 0; t < static_cast<int>(off.size()); ++t)
    if (off[t]) found.push_back(t);
  return found;
}

std::vector<LatticeCell> cells_in_dispute(const Field& field, const TriangleMesh& mesh, double limit,
                                          const SampledField& lattice, std::span<const LatticeBlock> blocks) {
  std::vector<LatticeBlock> slabs, read;
  for (const LatticeBlock& block : blocks) add_slabs(lattice, widened(lattice, block, 0), slabs);
  for (const LatticeBlock& slab : slabs) read.push_back(widened(lattice, slab, kOverlap));
  const WindingNumbers numbers(mesh.position, mesh.triangles, lattice, read);
  const auto near =
      triangles_near(lattice, mesh.position, mesh.triangles, slabs, kOverlap + limit / lattice.spacing);
  std::vector<std::vector<LatticeCell>> found(slabs.size());
  shared_lists(
      [&](std::size_t s) {
        SampledField part = lattice;
        restrict_to(read[s], part);
        for (LatticeCell cell : points_in_dispute(field, mesh, numbers, near[s], limit, part)) {
          for (int a = 0; a < 3; ++a) cell[a] += read[s].first[a];
          if (has(slabs[s], cell)) found[s].push_back(cell);
        }
      },
      found);
  std::vector<LatticeCell> cells;
  for (const std::vector<LatticeCell>& of_slab : found)
    cells.insert(cells.end(), of_slab.begin(), of_slab.end());
  return cells;
}

}  // namespace kappaflow
