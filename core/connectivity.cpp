#include "core/connectivity.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <numeric>
#include <utility>

#include "core/parallel.h"

namespace kappaflow {
namespace {

/// Calls visit(u, v, h) for every half-edge h, which runs from u to v.
template <class Visit>
void for_each_half_edge(std::span<const Triangle> triangles, const Visit& visit) {
  int h = 0;
  for (const auto& [a, b, c] : triangles) {
    visit(a, b, h++);
    visit(b, c, h++);
    visit(c, a, h++);
  }
}

/// How half-edges are sorted by the lower end of their edge, by its higher end and by number: into buckets by
/// the lower end, and in each by a key of all the rest. There are half as many buckets as half-edges at most,
/// so the cost does not depend on the vertices' numbers; in a whole mesh every vertex has a bucket of its
/// own.
class SideOrder {
 public:
  explicit SideOrder(std::span<const Triangle> triangles) : least_(triangles[0][0]) {
    int most = least_;
    for (const Triangle& t : triangles)
      for (const int v : t) {
        least_ = std::min(least_, v);
        most = std::max(most, v);
      }
    range_ = offset(most);
    const auto n = static_cast<std::uint32_t>(3 * triangles.size());
    shift_ = std::bit_width(range_ / (n / 2));
    high_bits_ = std::bit_width(range_);
    number_bits_ = std::bit_width(n - 1);
  }

  std::size_t buckets() const { return (range_ >> shift_) + 1; }
  std::size_t bucket(int u, int v) const { return offset(std::min(u, v)) >> shift_; }
  /// Of 64 bits at most: 2^shift is 1 or at most 4 range / n, and range < 2^31.
  std::uint64_t key(int u, int v, int h) const {
    const std::uint64_t low = offset(std::min(u, v)) & ((1u << shift_) - 1), high = offset(std::max(u, v));
    return (low << high_bits_ | high) << number_bits_ | static_cast<std::uint32_t>(h);
  }
  bool same_edge(std::uint64_t a, std::uint64_t b) const { return a >> number_bits_ == b >> number_bits_; }
  int half_edge(std::uint64_t key) const {
    return static_cast<int>(key & ((std::uint64_t{1} << number_bits_) - 1));
  }

 private:
  std::uint32_t offset(int v) const { return static_cast<std::uint32_t>(v - least_); }

  int least_;
  std::uint32_t range_;
  int shift_, high_bits_, number_bits_;
};

/// Sets that are united step by step.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t members) : parent_(members) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  void unite(int a, int b) {
    const auto [first, other] = std::minmax({first_of(a), first_of(b)});
    parent_[other] = first;
  }
  /// The set of each member, numbered from 0 by first member.
  std::vector<int> numbered() {
    std::vector<int> number(parent_.size());
    int sets = 0;
    for (int i = 0; i < static_cast<int>(number.size()); ++i)
      number[i] = parent_[i] == i ? sets++ : number[first_of(i)];
    return number;
  }

 private:
  int first_of(int a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  std::vector<int> parent_;  // never a later member
};

using Edge = std::pair<int, int>;

/// The directed edges of the boundary, ascending.
std::vector<Edge> open_edges(std::span<const Triangle> triangles) {
  const EdgeSides sides(triangles);
  std::vector<Edge> open;
  for (std::size_t e = 0; e < sides.edges(); ++e) {
    const std::span<const int> along = sides.of(e);
    const int u = origin_of(triangles, along[0]);
    if (along.size() == 2 && origin_of(triangles, along[1]) != u) continue;
    const auto from_u = std::ranges::count_if(along, [&](int h) { return origin_of(triangles, h) == u; });
    const auto surplus = 2 * from_u - std::ssize(along);
    const int v = end_of(triangles, along[0]);
    open.insert(open.end(), static_cast<std::size_t>(std::abs(surplus)),
                surplus > 0 ? Edge{u, v} : Edge{v, u});
  }
  std::ranges::sort(open);
  return open;
}

}  // namespace

void EdgeSides::assign(std::span<const Triangle> triangles) {
  start_.assign(1, 0);
  half_edge_.resize(3 * triangles.size());
  if (triangles.empty()) return;
  start_.reserve(half_edge_.size() / 2 + 1);
  const SideOrder order(triangles);
  bucket_.assign(order.buckets() + 2, 0);
  for_each_half_edge(triangles, [&](int u, int v, int) { ++bucket_[order.bucket(u, v) + 2]; });
  std::partial_sum(bucket_.begin(), bucket_.end(), bucket_.begin());
  key_.resize(half_edge_.size());
  // Entry b + 1, where bucket b begins, moves up to where it ends and bucket b + 1 begins.
  for_each_half_edge(
      triangles, [&](int u, int v, int h) { key_[bucket_[order.bucket(u, v) + 1]++] = order.key(u, v, h); });
  parallel_for(order.buckets(),
               [&](std::size_t b) { std::sort(key_.begin() + bucket_[b], key_.begin() + bucket_[b + 1]); });
  for (std::size_t b = 0; b < order.buckets(); ++b)
    for (int s = bucket_[b]; s < bucket_[b + 1]; ++s) {
      half_edge_[s] = order.half_edge(key_[s]);
      if (s + 1 == bucket_[b + 1] || !order.same_edge(key_[s], key_[s + 1])) start_.push_back(s + 1);
    }
}

std::vector<int> twins_of(std::span<const Triangle> triangles) {
  EdgeSides sides;
  std::vector<int> twin;
  twins_of(triangles, sides, twin);
  return twin;
}

void twins_of(std::span<const Triangle> triangles, EdgeSides& scratch, std::vector<int>& twin) {
  scratch.assign(triangles);
  twin.resize(3 * triangles.size());
  parallel_for(scratch.edges(), [&](std::size_t e) {
    const std::span<const int> along = scratch.of(e);
    const bool opposite =
        along.size() == 2 && origin_of(triangles, along[0]) != origin_of(triangles, along[1]);
    for (const int h : along) twin[h] = opposite ? along[0] + along[1] - h : -1;
  });
}

Boundary boundary_of(std::span<const Triangle> triangles) {
  const std::vector<Edge> open = open_edges(triangles);
  Boundary boundary;
  for (std::size_t e = 1; e < open.size(); ++e)
    if (open[e].first == open[e - 1].first) boundary.pinched.push_back(open[e].first);
  if (!boundary.pinched.empty()) return boundary;
  // At every vertex as many edges end as start: each loop closes.
  std::vector<char> done(open.size(), 0);
  for (std::size_t first = 0; first < open.size(); ++first) {
    if (done[first]) continue;
    std::vector<int>& loop = boundary.loops.emplace_back();
    for (std::size_t e = first; !done[e];) {
      done[e] = 1;
      loop.push_back(open[e].first);
      e = static_cast<std::size_t>(std::ranges::lower_bound(open, open[e].second, {}, &Edge::first) -
                                   open.begin());
    }
  }
  return boundary;
}

VertexRings vertex_rings(std::size_t vertex_count, std::span<const Triangle> triangles) {
  VertexRings rings;
  vertex_rings(vertex_count, triangles, rings);
  return rings;
}

void vertex_rings(std::size_t vertex_count, std::span<const Triangle> triangles, VertexRings& rings) {
  // Every triangle tells each of its corners of the two others; inside a closed mesh each neighbour comes
  // twice. That is a third faster than through the edges.
  rings.start.assign(vertex_count + 1, 0);
  for (const Triangle& triangle : triangles)
    for (const int v : triangle) rings.start[v + 1] += 2;
  std::partial_sum(rings.start.begin(), rings.start.end(), rings.start.begin());

  rings.neighbour.resize(6 * triangles.size());
  std::vector<int> end(rings.start.begin(), rings.start.end() - 1);
  for (const Triangle& triangle : triangles)
    for (int corner = 0; corner < 3; ++corner) {
      const int v = triangle[corner];
      rings.neighbour[end[v]++] = triangle[(corner + 1) % 3];
      rings.neighbour[end[v]++] = triangle[(corner + 2) % 3];
    }

  parallel_for(vertex_count, [&](std::size_t v) {
    const auto begin = rings.neighbour.begin() + rings.start[v], last = rings.neighbour.begin() + end[v];
    std::sort(begin, last);
    end[v] = rings.start[v] + static_cast<int>(std::unique(begin, last) - begin);
  });
  int kept = 0;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    const int first = std::exchange(rings.start[v], kept);
    std::copy(rings.neighbour.begin() + first, rings.neighbour.begin() + end[v],
              rings.neighbour.begin() + kept);
    kept += end[v] - first;
  }
  rings.start[vertex_count] = kept;
  rings.neighbour.resize(kept);
}

std::vector<int> triangle_pieces(std::span<const Triangle> triangles) {
  const EdgeSides sides(triangles);
  DisjointSets pieces(triangles.size());
  for (std::size_t e = 0; e < sides.edges(); ++e)
    for (const int h : sides.of(e).subspan(1)) pieces.unite(h / 3, sides.of(e)[0] / 3);
  return pieces.numbered();
}

std::vector<int> vertex_pieces(std::size_t vertex_count, std::span<const Triangle> triangles) {
  DisjointSets pieces(vertex_count);
  for (const auto& [a, b, c] : triangles) {
    pieces.unite(a, b);
    pieces.unite(b, c);
  }
  return pieces.numbered();
}

std::vector<std::vector<int>> members_by_piece(std::span<const int> piece) {
  std::vector<std::vector<int>> members;
  for (int i = 0; i < static_cast<int>(piece.size()); ++i) {
    if (piece[i] == static_cast<int>(members.size())) members.emplace_back();
    members[piece[i]].push_back(i);
  }
  return members;
}

}  // namespace kappaflow
