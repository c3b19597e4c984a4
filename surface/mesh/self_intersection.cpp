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
};

constexpr std::int32_t kAllAxes = 7;  // bits of three axes

/// Eight numbers from there on.
template <class T, class Number>
T eight_from(const Number* first) {
  T eight;
  std::memcpy(&eight, first, sizeof eight);
  return eight;
}

/// In single precision, which keeps the order: boxes that meet still do.
float single(double x) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(x, -kLargest, kLargest));
}

/// Triangles in the cells of a grid that their boxes meet; the first `known` only where one of the others is.
class TriangleGrid {
 public:
  TriangleGrid(std::span<const Vec3> position, std::span<const Triangle> triangles, std::size_t known)
      : position_(position), triangles_(triangles), known_(static_cast<int>(known)) {
    set_entries(make_boxes());
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

  /// The triangles' boxes; from them the size of the cells, and where they begin.
  std::vector<Box> make_boxes() {
    std::vector<Box> boxes(triangles_.size());
    Vec3 lower = Vec3::Constant(HUGE_VAL), upper = -lower, size = Vec3::Zero();
    for (std::size_t t = 0; t < boxes.size(); ++t) {
      const Vec3 &a = position_[triangles_[t][0]], &b = position_[triangles_[t][1]],
                 &c = position_[triangles_[t][2]];
      boxes[t] = {a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
      lower = lower.cwiseMin(boxes[t].lower);
      upper = upper.cwiseMax(boxes[t].upper);
      size += boxes[t].upper - boxes[t].lower;
    }
    origin_ = lower;
    const double mean = size.maxCoeff() / static_cast<double>(std::max<std::size_t>(1, boxes.size())),
                 extent = (upper - lower).maxCoeff();
    cell_size_ = std::max(2 * mean, extent / double{kMostCells});
    return boxes;
  }

  /// boxes: of the triangles.
  void set_entries(std::span<const Box> boxes) {
    std::vector<Entry> found, others;
    const auto for_each_cell = [&](std::size_t t, const auto& visit) {
      const Cell first = cell_of(boxes[t].lower), last = cell_of(boxes[t].upper);
      for (std::uint64_t k = first[2]; k <= last[2]; ++k)
        for (std::uint64_t j = first[1]; j <= last[1]; ++j)
          for (std::uint64_t i = first[0]; i <= last[0]; ++i)
            visit(Entry{cell_key(Cell{i, j, k}), static_cast<int>(t)});
    };
    for (std::size_t t = known_; t < boxes.size(); ++t)
      for_each_cell(t, [&](const Entry& entry) { others.push_back(entry); });
    if (known_ > 0) {
      const HashedBins cells(others);
      const auto is_shared = [&](std::uint64_t key) {
        return std::ranges::any_of(cells.near(key), [&](const Entry& other) { return other.key == key; });
      };
      for (std::size_t t = 0; t < static_cast<std::size_t>(known_); ++t)
        for_each_cell(t, [&](const Entry& entry) {
          if (is_shared(entry.key)) found.push_back(entry);
        });
    }
    found.insert(found.end(), others.begin(), others.end());
    bins_ = HashedBins(found);
    const std::size_t padded = found.size() + kWide;
    for (auto* side : {&lower_, &upper_})
      for (std::vector<float>& axis : *side) axis.resize(padded);
    for (std::vector<std::int32_t>& corner : corner_) corner.resize(padded);
    begins_.resize(padded);
    parallel_for(found.size(), [&](std::size_t e) { set_entry(e, boxes[bins_.entries()[e].number]); });
  }

  /// What is known of an entry for comparisons with others.
  void set_entry(std::size_t e, const Box& box) {
    const auto& [key, triangle] = bins_.entries()[e];
    const Cell first = cell_of(box.lower), cell = cell_of_key(key);
    for (int a = 0; a < 3; ++a) {
      lower_[a][e] = single(box.lower[a] - origin_[a]);
      upper_[a][e] = single(box.upper[a] - origin_[a]);
      corner_[a][e] = triangles_[triangle][a];
      begins_[e] |= std::int32_t{first[a] == cell[a]} << a;
    }
  }

  Cell cell_of(const Vec3& x) const {
    const Vec3 cells = (x - origin_) / cell_size_;
    const auto index = [&](int a) { return whole_within<std::uint64_t>(cells[a], 0, kMostCells); };
    return {index(0), index(1), index(2)};
  }
  static Cell cell_of_key(std::uint64_t key) {
    constexpr std::uint64_t kMask = (1u << 21) - 1;
    return {key >> 42, key >> 21 & kMask, key & kMask};
  }

  /// Of eight entries from b on, as bits, those that are to be compared with entry a if they are of its cell.
  /// Boxes that meet may do so in several cells: they count in the one that holds their common lower corner,
  /// where along each axis one of both begins. Most are those of neighbours along an edge, which cannot
  /// cross.
  unsigned candidates(std::size_t a, std::size_t b) const {
    const auto floats = [b](const std::vector<float>& values) { return eight_from<Eight>(&values[b]); };
    const auto ints = [b](const std::vector<std::int32_t>& values) {
      return eight_from<EightInts>(&values[b]);
    };
    const auto meets = [&](int axis) -> EightInts {
      return (floats(lower_[axis]) <= upper_[axis][a]) & (floats(upper_[axis]) >= lower_[axis][a]);
    };
    const EightInts met = meets(0) & meets(1) & meets(2) & ((ints(begins_) | begins_[a]) == kAllAxes);
    if (lanes_of(met) == 0) return 0;
    EightInts shared{};  // each corner that both have counts -1
    for (const std::vector<std::int32_t>& corner : corner_)
      for (const std::vector<std::int32_t>& other : corner_) shared += ints(other) == corner[a];
    return lanes_of(met & (shared > -2));
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
        for (unsigned lanes = candidates(a, b) & within; lanes != 0; lanes &= lanes - 1) {
          const std::size_t other = b + static_cast<std::size_t>(std::countr_zero(lanes));
          const int t = entries[a].number, u = entries[other].number;
          if (entries[a].key == entries[other].key &&
              triangles_cross(position_, triangles_[t], triangles_[u]))
            visit(t, u);
        }
      }
  }

  std::span<const Vec3> position_;
  std::span<const Triangle> triangles_;
  int known_;
  Vec3 origin_ = Vec3::Zero();
  double cell_size_ = 1;
  HashedBins bins_;
  std::array<std::vector<float>, 3> lower_, upper_;  // boxes of its entries, from the origin
  std::array<std::vector<std::int32_t>, 3> corner_;  // of the entries' triangles
  std::vector<std::int32_t> begins_;                 // bit a: along axis a the box begins in the entry's cell
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
