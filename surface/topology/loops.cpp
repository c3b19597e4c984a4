#include "surface/topology/loops.h"

#include <algorithm>

#include "core/triangle_geometry.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/topology/disagreement.h"

namespace kappaflow {
namespace {

constexpr double kFacingWeight = 4;  // [1] a triangle that faces sideways costs five times its size
constexpr double kBad = 100;         // [longest edges squared] where no better triangles are found

/// Where a loop is nearest to a polygon: an entry of each.
struct Bridge {
  std::size_t from = 0, to = 0;
  double length = kInfinity;
};

/// A place on the other side of the liquid is taken only where there is no other.
Bridge nearest_bridge(std::span<const Vec3> position, std::span<const Vec3> gradient,
                      std::span<const int> polygon, std::span<const int> loop) {
  Bridge best, across;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    for (std::size_t j = 0; j < loop.size(); ++j) {
      const double length = (position[polygon[i]] - position[loop[j]]).squaredNorm();
      if (!(length < best.length)) continue;
      if (gradient[polygon[i]].dot(gradient[loop[j]]) > 0)
        best = {i, j, length};
      else if (length < across.length)
        across = {i, j, length};
    }
  return best.length < kInfinity ? best : across;
}

/// Puts the loop, against its run, into the polygon.
void splice(const Bridge& bridge, std::span<const int> loop, std::vector<int>& polygon) {
  std::vector<int> detour;
  for (std::size_t i = 0; i <= loop.size(); ++i)
    detour.push_back(loop[(bridge.to + loop.size() - i % loop.size()) % loop.size()]);
  detour.push_back(polygon[bridge.from]);
  polygon.insert(polygon.begin() + static_cast<std::ptrdiff_t>(bridge.from) + 1, detour.begin(),
                 detour.end());
}

/// A line between two corners of a polygon; what fills the polygon between them.
struct Chord {
  int end;         // the one corner; whoever has the chord knows the other
  double squared;  // length [m2]
  double cost;     // of the triangles between; infinite where there are none
  int apex;        // the third corner of the triangle at the chord
};

/// Least costs of the polygon's parts, from short to long ones.
class PolygonFill {
 public:
  PolygonFill(std::span<const Vec3> position, std::span<const Vec3> gradient, std::span<const int> polygon,
              const FillRules& rules)
      : polygon_(polygon), rules_(rules), up_(polygon.size()), down_(polygon.size()) {
    for (const int v : polygon) {
      x_.push_back(position[v]);
      normal_.emplace_back(-gradient[v].normalized());
    }
    set_edges();
    for (int i = size() - 1; i >= 0; --i) add_chords(i);
  }

  std::vector<Triangle> triangles() const {
    std::vector<Triangle> result;
    std::vector<std::pair<int, int>> pending{{0, size() - 1}};
    while (!pending.empty()) {
      const auto [i, j] = pending.back();
      pending.pop_back();
      if (j < i + 2) continue;
      const auto chord = std::ranges::lower_bound(up_[i], j, {}, &Chord::end);
      if (chord == up_[i].end() || !(chord->cost < kInfinity)) return {};
      result.push_back({polygon_[i], polygon_[chord->apex], polygon_[j]});
      pending.emplace_back(i, chord->apex);
      pending.emplace_back(chord->apex, j);
    }
    return result;
  }

 private:
  int size() const { return static_cast<int>(polygon_.size()); }

  void set_edges() {
    edges_ = rules_.taken_edges;
    for (int i = 0; i < size(); ++i)
      edges_.emplace_back(std::minmax(polygon_[i], polygon_[(i + 1) % size()]));
    std::ranges::sort(edges_);
  }

  bool may_join(int i, int j, double squared) const {
    if (j == i + 1 || (i == 0 && j == size() - 1)) return true;
    return squared <= rules_.longest_edge * rules_.longest_edge && polygon_[i] != polygon_[j] &&
           !std::ranges::binary_search(edges_, std::pair<int, int>(std::minmax(polygon_[i], polygon_[j])));
  }

  void add_chords(int i) {
    for (int j = i + 1; j < size(); ++j) {
      const double squared = (x_[i] - x_[j]).squaredNorm();
      if (!may_join(i, j, squared)) continue;
      Chord chord{j, squared, j == i + 1 ? 0 : kInfinity, -1};
      if (j > i + 1) find_apex(i, chord);
      if (!(chord.cost < kInfinity)) continue;
      up_[i].push_back(chord);
      chord.end = i;
      down_[j].push_back(chord);
    }
  }

  /// Of the corners that have chords to both ends the one at which the triangles cost least.
  void find_apex(int i, Chord& chord) const {
    const std::vector<Chord>& falling = down_[chord.end];
    auto down = falling.rbegin();
    for (const Chord& up : up_[i]) {
      while (down != falling.rend() && down->end < up.end) ++down;
      if (down == falling.rend()) return;
      if (down->end != up.end) continue;
      const double parts = up.cost + down->cost,
                   longest = std::max({up.squared, down->squared, chord.squared});
      if (!(parts + longest < chord.cost)) continue;  // a triangle costs its longest edge squared at least
      const double all = parts + cost(i, up.end, chord.end, longest);
      if (all < chord.cost) chord = {chord.end, chord.squared, all, up.end};
    }
  }

  double cost(int i, int k, int j, double longest) const {
    const Vec3 normals = normal_[i] + normal_[k] + normal_[j];
    const double along = facing(x_[i], x_[k], x_[j], normals);
    const bool is_bad = (normals_agree(normals) && !(along > 0)) || is_refused(i, k, j);
    return longest * (1 + kFacingWeight * (1 - along)) +
           (is_bad ? kBad * rules_.longest_edge * rules_.longest_edge : 0);
  }

  bool is_refused(int i, int k, int j) const {
    if (rules_.refused.empty()) return false;
    Triangle corners{polygon_[i], polygon_[k], polygon_[j]};
    std::ranges::sort(corners);
    return std::ranges::binary_search(rules_.refused, corners);
  }

  std::span<const int> polygon_;
  const FillRules& rules_;
  std::vector<Vec3> x_, normal_;  // of each corner
  std::vector<std::pair<int, int>> edges_;
  std::vector<std::vector<Chord>> up_,
      down_;  // of each corner: those to higher ones, rising; to lower, falling
};

}  // namespace

std::vector<int> bridged_polygon(std::span<const Vec3> position, std::span<const Vec3> gradient,
                                 std::span<const int> hole, std::span<const std::vector<int>> inside) {
  std::vector<int> polygon(hole.begin(), hole.end());
  std::vector<char> done(inside.size(), 0);
  for (std::size_t n = 0; n < inside.size(); ++n) {
    Bridge shortest;
    std::size_t next = 0;
    for (std::size_t l = 0; l < inside.size(); ++l) {
      if (done[l]) continue;
      const Bridge bridge = nearest_bridge(position, gradient, polygon, inside[l]);
      if (!(bridge.length < shortest.length)) continue;
      shortest = bridge;
      next = l;
    }
    splice(shortest, inside[next], polygon);
    done[next] = 1;
  }
  return polygon;
}

std::vector<Triangle> fill_polygon(std::span<const Vec3> position, std::span<const Vec3> gradient,
                                   std::span<const int> polygon, const FillRules& rules) {
  return PolygonFill(position, gradient, polygon, rules).triangles();
}

}  // namespace kappaflow
