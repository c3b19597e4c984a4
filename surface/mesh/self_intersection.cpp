// A uniform grid finds the pairs.
#include "surface/mesh/self_intersection.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#include "core/hashed_bins.h"
#include "core/parallel.h"
#include "core/triangle_crossing.h"
#include "core/whole_within.h"
#include "core/wide.h"

namespace kappaflow {
namespace {

constexpr std::uint64_t kMostCells = 1048576;  // along an axis: an index has 21 bits of a key

struct Box {
  Vec3 lower, upper;
  bool meets(const Box& other) const {
    return (lower.array() <= other.upper.array()).all() && (other.lower.array() <= upper.array()).all();
  }
};

using Corners = std::array<Vec3, 3>;

/// In single precision, which keeps the order: boxes that meet still do.
float single(double x) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(x, -kLargest, kLargest));
}

/// Triangles in the cells of a grid that their boxes meet; of the first `known` those that may meet one of
/// the others.
class TriangleGrid {
 public:
  TriangleGrid(std::span<const Vec3> position, std::span<const Triangle> triangles, std::size_t known)
      : position_(position),
        triangles_(triangles),
        known_(static_cast<int>(known)),
        boxes_(triangles.size()) {
    set_boxes();
    set_entries();
  }

  std::size_t intersections() const {
    return parallel_sum(bins_.buckets(), std::size_t{0}, [&](std::size_t bucket) {
      std::size_t found = 0;
      for_each_intersection(bucket, [&](int, int) { ++found; });
      return found;
    });
  }

  std::vector<char> is_intersecting() const {
    // Several cells may mark one triangle at once, all with the same value.
    std::vector<std::atomic<char>> marked(triangles_.size());
    parallel_for(bins_.buckets(), [&](std::size_t bucket) {
      for_each_intersection(bucket, [&](int a, int b) {
        marked[a].store(1, std::memory_order_relaxed);
        marked[b].store(1, std::memory_order_relaxed);
      });
    });
    return {marked.begin(), marked.end()};
  }

 private:
  using Entry = HashedBins::Entry;  // a cell's key and a triangle
  using Cell = std::array<std::uint64_t, 3>;

  void set_boxes() {
    Vec3 lower = Vec3::Constant(HUGE_VAL), upper = -lower, size = Vec3::Zero();
    for (std::size_t t = 0; t < boxes_.size(); ++t) {
      const auto& [a, b, c] = corners(static_cast<int>(t));
      boxes_[t] = {a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
      lower = lower.cwiseMin(boxes_[t].lower);
      upper = upper.cwiseMax(boxes_[t].upper);
      size += boxes_[t].upper - boxes_[t].lower;
    }
    origin_ = lower;
    const double mean = size.maxCoeff() / static_cast<double>(std::max<std::size_t>(1, boxes_.size())),
                 extent = (upper - lower).maxCoeff();
    cell_size_ = std::max(2 * mean, extent / double{kMostCells});
  }

  void set_entries() {
    Box others = {Vec3::Constant(HUGE_VAL), Vec3::Constant(-HUGE_VAL)};
    for (std::size_t t = known_; t < boxes_.size(); ++t)
      others = {others.lower.cwiseMin(boxes_[t].lower), others.upper.cwiseMax(boxes_[t].upper)};
    std::vector<Entry> found;
    for (int t = 0; t < static_cast<int>(boxes_.size()); ++t) {
      if (t < known_ && !boxes_[t].meets(others)) continue;
      const Cell first = cell_of(boxes_[t].lower), last = cell_of(boxes_[t].upper);
      for (std::uint64_t k = first[2]; k <= last[2]; ++k)
        for (std::uint64_t j = first[1]; j <= last[1]; ++j)
          for (std::uint64_t i = first[0]; i <= last[0]; ++i) found.push_back({key({i, j, k}), t});
    }
    bins_ = HashedBins(found);
    for (auto* side : {&lower_, &upper_})
      for (std::vector<float>& axis : *side) axis.resize(found.size() + kWide);
    for (std::size_t e = 0; e < found.size(); ++e)
      for (int a = 0; a < 3; ++a) {
        const Box& box = boxes_[bins_.entries()[e].number];
        lower_[a][e] = single(box.lower[a] - origin_[a]);
        upper_[a][e] = single(box.upper[a] - origin_[a]);
      }
  }

  Corners corners(int t) const {
    const Triangle& triangle = triangles_[t];
    return {position_[triangle[0]], position_[triangle[1]], position_[triangle[2]]};
  }
  Cell cell_of(const Vec3& x) const {
    const Vec3 cells = (x - origin_) / cell_size_;
    const auto index = [&](int a) { return whole_within<std::uint64_t>(cells[a], 0, kMostCells); };
    return {index(0), index(1), index(2)};
  }
  static std::uint64_t key(const Cell& cell) { return cell[0] << 42 | cell[1] << 21 | cell[2]; }

  /// Of eight entries from b on, those whose box may meet that of entry a, as bits.
  unsigned boxes_met(std::size_t a, std::size_t b) const {
    const auto load = [b](const std::vector<float>& values) -> Eight {
      Eight eight;
      std::memcpy(&eight, &values[b], sizeof eight);
      return eight;
    };
    const auto meets = [&](int axis) -> EightInts {
      return (load(lower_[axis]) <= upper_[axis][a]) & (load(upper_[axis]) >= lower_[axis][a]);
    };
    return lanes_of(meets(0) & meets(1) & meets(2));
  }

  /// A pair may meet in several cells; it counts in the one that holds their boxes' common lower corner.
  bool cross_in(const Entry& a, const Entry& b) const {
    if (a.key != b.key || share_edge(triangles_[a.number], triangles_[b.number])) return false;
    const Box &box_a = boxes_[a.number], &box_b = boxes_[b.number];
    return box_a.meets(box_b) && key(cell_of(box_a.lower.cwiseMax(box_b.lower))) == a.key &&
           triangles_cross(position_, triangles_[a.number], triangles_[b.number]);
  }

  /// Most boxes that meet are those of neighbours, which cannot cross: triangles_cross() would find that
  /// later.
  static bool share_edge(const Triangle& a, const Triangle& b) {
    int shared = 0;
    for (const int v : a) shared += v == b[0] || v == b[1] || v == b[2];
    return shared >= 2;
  }

  template <class Visit>
  void for_each_intersection(std::size_t bucket, const Visit& visit) const {
    const std::span<const Entry> entries = bins_.entries();
    std::size_t first_other = bins_.start(bucket);  // triangles ascend
    const std::size_t end = bins_.start(bucket + 1);
    while (first_other < end && entries[first_other].number < known_) ++first_other;
    for (std::size_t a = bins_.start(bucket); a < end; ++a)
      for (std::size_t b = std::max(a + 1, first_other); b < end; b += kWide) {
        const unsigned within = end - b < kWide ? (1u << (end - b)) - 1 : ~0u;
        for (unsigned lanes = boxes_met(a, b) & within; lanes != 0; lanes &= lanes - 1) {
          const std::size_t other = b + static_cast<std::size_t>(std::countr_zero(lanes));
          if (cross_in(entries[a], entries[other])) visit(entries[a].number, entries[other].number);
        }
      }
  }

  std::span<const Vec3> position_;
  std::span<const Triangle> triangles_;
  int known_;
  std::vector<Box> boxes_;
  Vec3 origin_ = Vec3::Zero();
  double cell_size_ = 1;
  HashedBins bins_;
  std::array<std::vector<float>, 3> lower_, upper_;  // boxes of its entries, from the origin
};

}  // namespace

std::size_t self_intersections(std::span<const Vec3> position, std::span<const Triangle> triangles) {
  if (triangles.empty()) return 0;
  return TriangleGrid(position, triangles, 0).intersections();
}

std::vector<int> intersecting_triangles(std::span<const Vec3> position, std::span<const Triangle> triangles,
                                        std::size_t known) {
  std::vector<int> found;
  if (triangles.empty()) return found;
  const std::vector<char> marked = TriangleGrid(position, triangles, known).is_intersecting();
  for (int t = 0; t < static_cast<int>(marked.size()); ++t)
    if (marked[t]) found.push_back(t);
  return found;
}

}  // namespace kappaflow
