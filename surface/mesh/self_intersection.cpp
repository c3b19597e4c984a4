// A uniform grid finds the pairs.
#include "surface/mesh/self_intersection.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "core/triangle_crossing.h"
#include "core/whole_within.h"

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
    return parallel_sum(cell_start_.size() - 1, std::size_t{0}, [&](std::size_t cell) {
      std::size_t found = 0;
      for_each_intersection(cell, [&](int, int) { ++found; });
      return found;
    });
  }

  std::vector<char> is_intersecting() const {
    // Several cells may mark one triangle at once, all with the same value.
    std::vector<std::atomic<char>> marked(triangles_.size());
    parallel_for(cell_start_.size() - 1, [&](std::size_t cell) {
      for_each_intersection(cell, [&](int a, int b) {
        marked[a].store(1, std::memory_order_relaxed);
        marked[b].store(1, std::memory_order_relaxed);
      });
    });
    return {marked.begin(), marked.end()};
  }

 private:
  struct Entry {
    std::uint64_t cell;
    int triangle;
    bool operator<(const Entry& other) const {
      return cell != other.cell ? cell < other.cell : triangle < other.triangle;
    }
  };
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
    const double mean = size.maxCoeff() / static_cast<double>(std::max<std::size_t>(1, boxes_.size()));
    cell_size_ = std::max(2 * mean, (upper - lower).maxCoeff() / double{kMostCells});
  }

  void set_entries() {
    Box others = {Vec3::Constant(HUGE_VAL), Vec3::Constant(-HUGE_VAL)};
    for (std::size_t t = known_; t < boxes_.size(); ++t)
      others = {others.lower.cwiseMin(boxes_[t].lower), others.upper.cwiseMax(boxes_[t].upper)};
    for (int t = 0; t < static_cast<int>(boxes_.size()); ++t) {
      if (t < known_ && !boxes_[t].meets(others)) continue;
      const Cell first = cell_of(boxes_[t].lower), last = cell_of(boxes_[t].upper);
      for (std::uint64_t k = first[2]; k <= last[2]; ++k)
        for (std::uint64_t j = first[1]; j <= last[1]; ++j)
          for (std::uint64_t i = first[0]; i <= last[0]; ++i) entries_.push_back({key({i, j, k}), t});
    }
    std::sort(entries_.begin(), entries_.end());
    for (std::size_t e = 0; e < entries_.size(); ++e)
      if (e == 0 || entries_[e].cell != entries_[e - 1].cell) cell_start_.push_back(e);
    cell_start_.push_back(entries_.size());
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

  template <class Visit>
  void for_each_intersection(std::size_t cell, const Visit& visit) const {
    std::size_t first_other = cell_start_[cell];  // entries ascend
    while (first_other < cell_start_[cell + 1] && entries_[first_other].triangle < known_) ++first_other;
    for (std::size_t a = cell_start_[cell]; a < cell_start_[cell + 1]; ++a)
      for (std::size_t b = std::max(a + 1, first_other); b < cell_start_[cell + 1]; ++b) {
        const Box &box_a = boxes_[entries_[a].triangle], &box_b = boxes_[entries_[b].triangle];
        if (!box_a.meets(box_b)) continue;
        // A pair may meet in several cells; it counts in the one that holds their boxes' common lower corner.
        if (key(cell_of(box_a.lower.cwiseMax(box_b.lower))) != entries_[a].cell) continue;
        const int s = entries_[a].triangle, t = entries_[b].triangle;
        if (triangles_cross(position_, triangles_[s], triangles_[t])) visit(s, t);
      }
  }

  std::span<const Vec3> position_;
  std::span<const Triangle> triangles_;
  int known_;
  std::vector<Box> boxes_;
  Vec3 origin_ = Vec3::Zero();
  double cell_size_ = 1;
  std::vector<Entry> entries_;
  std::vector<std::size_t> cell_start_;
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
