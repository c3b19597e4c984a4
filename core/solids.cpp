#include "core/solids.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/connectivity.h"
#include "core/errors.h"
#include "core/parallel.h"
#include "core/triangle_crossing.h"
#include "core/triangle_tree.h"

namespace kappaflow {
namespace {

/// Triangles that are connected by edges: a mere vertex may belong to several pieces.
struct Piece {
  std::vector<int> triangles;  ///< their numbers, ascending
  Vec3 lower, upper;           ///< its box [m]
  double volume = 0;           ///< signed: negative where it faces inward [m3]
};

std::string place(const Vec3& x) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", x.x(), x.y(), x.z());
}

TriangleTree::Corners corners_of(const TriangleSurface& surface, std::size_t t) {
  const auto& [a, b, c] = surface.triangles[t];
  return {surface.vertices[a], surface.vertices[b], surface.vertices[c]};
}

Vec3 lower_of(const TriangleTree::Corners& corner) {
  return corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]);
}
Vec3 upper_of(const TriangleTree::Corners& corner) {
  return corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]);
}

void measure(const TriangleSurface& surface, Piece& piece) {
  const Vec3 apex = corners_of(surface, piece.triangles[0])[0];
  piece.lower = piece.upper = apex;
  for (const int t : piece.triangles) {
    const TriangleTree::Corners corner = corners_of(surface, t);
    piece.lower = piece.lower.cwiseMin(lower_of(corner));
    piece.upper = piece.upper.cwiseMax(upper_of(corner));
    piece.volume += (corner[0] - apex).dot((corner[1] - apex).cross(corner[2] - apex)) / 6;
  }
}

/// In the order of their first triangles.
std::vector<Piece> pieces_of(const TriangleSurface& surface) {
  std::vector<Piece> pieces;
  for (std::vector<int>& triangles : members_by_piece(triangle_pieces(surface.triangles))) {
    Piece& piece = pieces.emplace_back();
    piece.triangles = std::move(triangles);
    measure(surface, piece);
  }
  return pieces;
}

/// How often the piece winds around x (van Oosterom & Strackee, "The solid angle of a plane triangle", 1983).
double winding(const TriangleSurface& surface, const Piece& piece, const Vec3& x) {
  double sum = 0;
  for (const int t : piece.triangles) {
    auto [a, b, c] = corners_of(surface, t);
    a -= x, b -= x, c -= x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (2 * std::numbers::pi);
}

bool encloses(const TriangleSurface& surface, const Piece& piece, const Vec3& x) {
  if ((x.array() < piece.lower.array()).any() || (x.array() > piece.upper.array()).any()) return false;
  return std::abs(winding(surface, piece, x)) > 0.5;
}

/// The smallest piece facing outward that the one facing inward lies in.
std::size_t piece_around(const TriangleSurface& surface, std::span<const Piece> pieces, const Piece& inner) {
  const Vec3 x = corners_of(surface, inner.triangles[0])[0];
  std::size_t smallest = pieces.size();
  int depth = 0;  // in how many solids
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    if (&pieces[p] == &inner || !encloses(surface, pieces[p], x)) continue;
    depth += pieces[p].volume > 0 ? 1 : -1;
    if (pieces[p].volume > 0 && (smallest == pieces.size() || pieces[p].volume < pieces[smallest].volume))
      smallest = p;
  }
  if (depth < 1)
    throw InvalidInput(fmt::format("has a piece at {} that faces inward and lies in no solid", place(x)));
  return smallest;
}

/// number: of the vertices in the last part that was made of the surface; -1 throughout, as it is left.
TriangleSurface part_of(const TriangleSurface& surface, std::span<const int> triangles,
                        std::vector<int>& number) {
  TriangleSurface part;
  std::vector<int> used;
  for (const int t : triangles) {
    Triangle triangle = surface.triangles[t];
    for (int& v : triangle) {
      if (number[v] < 0) {
        number[v] = static_cast<int>(used.size());
        used.push_back(v);
      }
      v = number[v];
    }
    part.triangles.push_back(triangle);
  }
  for (const int v : used) {
    part.vertices.push_back(surface.vertices[v]);
    number[v] = -1;
  }
  return part;
}

}  // namespace

void check_crossings(const TriangleSurface& surface) {
  check_surface(surface);
  const std::vector<Piece> pieces = pieces_of(surface);
  const std::size_t n = surface.triangles.size();
  std::vector<int> piece_of(n);
  std::vector<TriangleTree::Corners> corners(n);
  for (std::size_t t = 0; t < n; ++t) corners[t] = corners_of(surface, t);
  for (std::size_t p = 0; p < pieces.size(); ++p)
    for (const int t : pieces[p].triangles) piece_of[t] = static_cast<int>(p);
  const auto may_cross = [&](std::size_t s, std::size_t t) {
    return piece_of[s] != piece_of[t] && pieces[piece_of[s]].volume > 0 && pieces[piece_of[t]].volume > 0;
  };
  const TriangleTree tree(corners);
  std::vector<std::uint32_t> crossed(n);  // the last triangle that each crosses, or itself
  parallel_for(n, [&](std::size_t t) {
    crossed[t] = static_cast<std::uint32_t>(t);
    tree.visit_near(lower_of(corners[t]), upper_of(corners[t]), [&](std::uint32_t s) {
      if (s > crossed[t] && !may_cross(s, t) &&
          triangles_cross(surface.vertices, surface.triangles[t], surface.triangles[s]))
        crossed[t] = s;
    });
  });
  for (std::size_t t = 0; t < n; ++t) {
    if (crossed[t] == t) continue;
    const TriangleTree::Corners &a = corners[t], &b = corners[crossed[t]];
    const Vec3 middle = (lower_of(a).cwiseMax(lower_of(b)) + upper_of(a).cwiseMin(upper_of(b))) / 2;
    const bool itself = piece_of[t] == piece_of[crossed[t]];
    throw InvalidInput(fmt::format(
        "has a piece that {} at about {}",
        itself ? "passes through itself" : "faces inward and passes through another", place(middle)));
  }
}

std::vector<TriangleSurface> solids_of(const TriangleSurface& surface) {
  check_surface(surface);
  const std::vector<Piece> pieces = pieces_of(surface);
  if (pieces.size() <= 1) return {surface};
  std::vector<std::vector<int>> triangles(pieces.size());
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    std::vector<int>& solid = triangles[pieces[p].volume > 0 ? p : piece_around(surface, pieces, pieces[p])];
    solid.insert(solid.end(), pieces[p].triangles.begin(), pieces[p].triangles.end());
  }
  std::vector<TriangleSurface> solids;
  std::vector<int> number(surface.vertices.size(), -1);
  for (std::vector<int>& solid : triangles) {
    if (solid.empty()) continue;
    std::ranges::sort(solid);
    solids.push_back(part_of(surface, solid, number));
  }
  return solids;
}

std::vector<SolidDistance> solid_distances(std::span<const TriangleSurface> surfaces) {
  std::vector<SolidDistance> distances;
  for (const TriangleSurface& surface : surfaces)
    for (const TriangleSurface& solid : solids_of(surface)) distances.emplace_back(solid);
  return distances;
}

}  // namespace kappaflow
