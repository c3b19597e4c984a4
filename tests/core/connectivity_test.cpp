// The connectivity of triangles against what maps of edges say, slowly and obviously.
#include "core/connectivity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>

namespace kappaflow {
namespace {

using Edge = std::pair<int, int>;

/// A closed torus of 2 n m triangles over the vertices first, first + 1, ...
std::vector<Triangle> torus(int n, int m, int first) {
  std::vector<Triangle> triangles;
  const auto at = [&](int i, int j) { return first + i % n * m + j % m; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return triangles;
}

/// Two tori of 30 and 35 vertices, their triangles shuffled and turned; number: of each vertex.
std::vector<Triangle> closed_mesh(std::mt19937& random, const std::vector<int>& number) {
  std::vector<Triangle> triangles = torus(5, 6, 0), other = torus(7, 5, 30);
  triangles.insert(triangles.end(), other.begin(), other.end());
  std::ranges::shuffle(triangles, random);
  for (Triangle& t : triangles) {
    std::rotate(t.begin(), t.begin() + random() % 3, t.end());
    for (int& v : t) v = number[v];
  }
  return triangles;
}

std::vector<int> shuffled_numbers(std::mt19937& random) {
  std::vector<int> number(65);
  for (int v = 0; v < 65; ++v) number[v] = v;
  std::ranges::shuffle(number, random);
  return number;
}

struct Example {
  std::string name;
  std::vector<Triangle> triangles;
};

/// Meshes, parts of them, and what is no part of any: all over less than 100 vertices.
std::vector<Example> examples() {
  std::vector<Example> all{{"nothing", {}},
                           {"one", {{4, 2, 7}}},
                           {"twice the same", {{4, 2, 7}, {2, 7, 4}}},
                           {"both sides of one", {{4, 2, 7}, {2, 4, 7}}},
                           {"without area", {{3, 3, 5}, {5, 3, 6}, {1, 1, 1}}},
                           {"pinched", {{0, 1, 2}, {2, 3, 4}}},
                           {"a fin", {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}}};
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::vector<Triangle> mesh = closed_mesh(random, shuffled_numbers(random));
    all.push_back({"closed", mesh});
    for (const std::size_t size : {129u, 127u, 60u, 20u}) {
      mesh.resize(size);
      all.push_back({"open", mesh});
    }
    for (Triangle& t : mesh)
      for (int& v : t) v = static_cast<int>(random() % 9);
    all.push_back({"any triangles", mesh});
  }
  return all;
}

std::map<Edge, std::vector<int>> half_edges_by_edge(const std::vector<Triangle>& triangles) {
  std::map<Edge, std::vector<int>> edges;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
    for (int c = 0; c < 3; ++c)
      edges[std::minmax(triangles[t][c], triangles[t][(c + 1) % 3])].push_back(3 * t + c);
  return edges;
}

TEST(Connectivity, HalfEdgesRunFromCornerToCorner) {
  const std::vector<Triangle> triangles{{0, 1, 2}, {7, 8, 9}};
  EXPECT_EQ(origin_of(triangles, 3), 7);
  EXPECT_EQ(end_of(triangles, 5), 7);
  for (int h = 0; h < 6; ++h) {
    EXPECT_EQ(origin_of(triangles, next_half_edge(h)), end_of(triangles, h));
    EXPECT_EQ(previous_half_edge(next_half_edge(h)), h);
  }
}

TEST(Connectivity, SidesAreThoseOfEachEdgeInOrder) {
  EdgeSides reused;
  for (const auto& [name, triangles] : examples()) {
    const auto oracle = half_edges_by_edge(triangles);
    const EdgeSides sides(triangles);
    reused.assign(triangles);
    ASSERT_EQ(sides.edges(), oracle.size()) << name;
    ASSERT_EQ(reused.edges(), oracle.size()) << name;
    std::size_t e = 0;
    for (const auto& [edge, half_edges] : oracle) {
      EXPECT_TRUE(std::ranges::equal(sides.of(e), half_edges)) << name;
      EXPECT_TRUE(std::ranges::equal(reused.of(e), half_edges)) << name;
      ++e;
    }
  }
}

// As many entries as the largest number would not fit into any memory.
TEST(Connectivity, DoesNotDependOnTheNumbersOfVertices) {
  constexpr int kLargest = std::numeric_limits<int>::max();
  std::mt19937 random(1);
  for (const int spread : {1, 3, 1000, kLargest / 65}) {
    std::vector<int> near = shuffled_numbers(random), far = near;
    std::ranges::sort(far);
    for (int& v : far) v = kLargest - (64 - v) * spread;
    far[0] = std::min(far[0], 0);
    std::vector<int> renumbered;
    for (const int v : near) renumbered.push_back(far[v]);
    for (const std::size_t size : {130u, 50u, 7u, 4u, 1u}) {
      std::mt19937 same(2), again(2);
      std::vector<Triangle> a = closed_mesh(same, near), b = closed_mesh(again, renumbered);
      a.resize(size);
      b.resize(size);
      const EdgeSides of_a(a), of_b(b);
      ASSERT_EQ(of_a.edges(), of_b.edges());
      for (std::size_t e = 0; e < of_a.edges(); ++e) EXPECT_TRUE(std::ranges::equal(of_a.of(e), of_b.of(e)));
      EXPECT_EQ(twins_of(a), twins_of(b));
      EXPECT_EQ(triangle_pieces(a), triangle_pieces(b));
      EXPECT_EQ(boundary_of(a).loops.size(), boundary_of(b).loops.size());
    }
  }
}

TEST(Connectivity, TwinsAreWhereAnEdgeHasOneTriangleEachWay) {
  for (const auto& [name, triangles] : examples()) {
    const std::vector<int> twin = twins_of(triangles);
    ASSERT_EQ(twin.size(), 3 * triangles.size());
    EXPECT_TRUE(name != "closed" || std::ranges::count(twin, -1) == 0);
    const auto oracle = half_edges_by_edge(triangles);
    for (int h = 0; h < static_cast<int>(twin.size()); ++h) {
      const int u = origin_of(triangles, h), v = end_of(triangles, h);
      const std::vector<int>& along = oracle.at(std::minmax(u, v));
      const int other = along.size() != 2 ? -1 : along[0] == h ? along[1] : along[0];
      EXPECT_EQ(twin[h], other >= 0 && origin_of(triangles, other) == v && u != v ? other : -1) << name;
    }
  }
}

/// The directed edges of the boundary.
std::multiset<Edge> open_edges(const std::vector<Triangle>& triangles) {
  std::map<Edge, int> surplus;
  for (const auto& [a, b, c] : triangles)
    for (const Edge& edge : {Edge(a, b), Edge(b, c), Edge(c, a)}) {
      ++surplus[edge];
      if (edge.first != edge.second) --surplus[{edge.second, edge.first}];
    }
  std::multiset<Edge> open;
  for (const auto& [edge, times] : surplus)
    for (int i = 0; i < times; ++i) open.insert(edge);
  return open;
}

TEST(Connectivity, LoopsHoldTheEdgesOfTheBoundary) {
  int with_loops = 0, pinched = 0;
  for (const auto& [name, triangles] : examples()) {
    const Boundary boundary = boundary_of(triangles);
    const std::multiset<Edge> open = open_edges(triangles);
    std::map<int, int> starting;
    for (const Edge& edge : open) ++starting[edge.first];
    std::set<int> several;
    for (const auto& [v, times] : starting)
      if (times > 1) several.insert(v);
    EXPECT_EQ(std::set(boundary.pinched.begin(), boundary.pinched.end()), several) << name;
    EXPECT_TRUE(std::ranges::is_sorted(boundary.pinched));
    std::multiset<Edge> found;
    int last_first = -1;
    for (const std::vector<int>& loop : boundary.loops) {
      EXPECT_EQ(loop[0], std::ranges::min(loop)) << name;
      EXPECT_GT(loop[0], last_first) << name;
      last_first = loop[0];
      for (std::size_t i = 0; i < loop.size(); ++i) found.emplace(loop[i], loop[(i + 1) % loop.size()]);
    }
    EXPECT_EQ(found, several.empty() ? open : std::multiset<Edge>()) << name;
    with_loops += !boundary.loops.empty();
    pinched += !several.empty();
  }
  EXPECT_GT(with_loops, 10);
  EXPECT_GT(pinched, 10);
}

TEST(Boundary, LoopsRunAsTheTrianglesDo) {
  // A square ring of eight triangles: the outer loop counter-clockwise, the inner one clockwise.
  const std::vector<Triangle> ring{{0, 1, 4}, {1, 5, 4}, {1, 2, 5}, {2, 6, 5},
                                   {2, 3, 6}, {3, 7, 6}, {3, 0, 7}, {0, 4, 7}};
  const Boundary boundary = boundary_of(ring);
  EXPECT_TRUE(boundary.pinched.empty());
  ASSERT_EQ(boundary.loops.size(), 2u);
  EXPECT_EQ(boundary.loops[0], (std::vector{0, 1, 2, 3}));
  EXPECT_EQ(boundary.loops[1], (std::vector{4, 7, 6, 5}));
}

TEST(Boundary, PinchedVerticesAreFound) {
  EXPECT_EQ(boundary_of(std::vector<Triangle>{{0, 1, 2}, {2, 3, 4}}).pinched, std::vector{2});
  EXPECT_TRUE(boundary_of({}).loops.empty());
}

/// The piece of each of n members, numbered by first member, where connected(i, j) says which are neighbours.
template <class Connected>
std::vector<int> flooded(int n, const Connected& connected) {
  std::vector<int> piece(n, -1);
  int pieces = 0;
  for (int seed = 0; seed < n; ++seed) {
    if (piece[seed] >= 0) continue;
    std::vector<int> pending{seed};
    piece[seed] = pieces++;
    while (!pending.empty()) {
      const int i = pending.back();
      pending.pop_back();
      for (int j = 0; j < n; ++j)
        if (piece[j] < 0 && connected(i, j)) {
          piece[j] = piece[seed];
          pending.push_back(j);
        }
    }
  }
  return piece;
}

TEST(Connectivity, PiecesOfTrianglesAreConnectedAcrossEdges) {
  for (const auto& [name, triangles] : examples()) {
    std::vector<std::set<Edge>> edges;
    for (const auto& [a, b, c] : triangles)
      edges.push_back({std::minmax(a, b), std::minmax(b, c), std::minmax(c, a)});
    const auto share_an_edge = [&](int s, int t) {
      return std::ranges::any_of(edges[s], [&](const Edge& edge) { return edges[t].contains(edge); });
    };
    EXPECT_EQ(triangle_pieces(triangles), flooded(static_cast<int>(triangles.size()), share_an_edge)) << name;
  }
  EXPECT_EQ(triangle_pieces(std::vector<Triangle>{{0, 1, 2}, {2, 3, 4}, {1, 0, 5}}), (std::vector{0, 1, 0}));
}

TEST(Connectivity, PiecesOfVerticesAreConnectedThroughTriangles) {
  for (const auto& [name, triangles] : examples()) {
    std::set<Edge> neighbours;
    for (const Triangle& t : triangles)
      for (const int u : t)
        for (const int v : t) neighbours.emplace(u, v);
    EXPECT_EQ(vertex_pieces(100, triangles), flooded(100,
                                                     [&](int u, int v) {
                                                       return neighbours.contains({u, v});
                                                     }))
        << name;
  }
  EXPECT_EQ(vertex_pieces(6, std::vector<Triangle>{{1, 2, 3}, {3, 4, 5}}), (std::vector{0, 1, 1, 1, 1, 1}));
}

TEST(Connectivity, MembersOfPiecesAreInOrder) {
  EXPECT_EQ(members_by_piece(std::vector{0, 0, 1, 0, 2, 1}),
            (std::vector<std::vector<int>>{{0, 1, 3}, {2, 5}, {4}}));
  EXPECT_TRUE(members_by_piece({}).empty());
}

TEST(VertexRings, ListEveryNeighbourOnceAscendingAndFindIt) {
  for (const auto& [name, triangles] : examples()) {
    std::vector<std::set<int>> oracle(100);
    for (const Triangle& t : triangles)
      for (int c = 0; c < 3; ++c) oracle[t[c]].insert({t[(c + 1) % 3], t[(c + 2) % 3]});
    const VertexRings rings = vertex_rings(100, triangles);
    ASSERT_EQ(rings.start.size(), 101u);
    for (int u = 0; u < 100; ++u) {
      EXPECT_TRUE(std::ranges::equal(rings.of(u), oracle[u])) << name;
      for (int v = 0; v < 100; ++v) {
        const int place = rings.place_of(u, v);
        ASSERT_EQ(place >= 0, oracle[u].contains(v)) << name;
        if (place < 0) continue;
        EXPECT_EQ(rings.neighbour[place], v);
        EXPECT_TRUE(rings.start[u] <= place && place < rings.start[u + 1]);
      }
    }
  }
}

TEST(VertexRings, VertexWithoutTrianglesHasNone) {
  const std::vector<Triangle> triangle{{0, 1, 3}};
  const VertexRings rings = vertex_rings(4, triangle);
  EXPECT_TRUE(rings.of(2).empty());
  EXPECT_EQ(rings.of(3).size(), 2u);
}

}  // namespace
}  // namespace kappaflow
