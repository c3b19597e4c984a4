#include "surface/topology/simple_points.h"

#include <array>
#include <bit>

namespace kappaflow {
namespace {

constexpr int kCentre = 13;
constexpr Neighbourhood kOthers = ((1u << 27) - 1) & ~(1u << kCentre);

constexpr int distance(int a, int b, int axis) {
  const int d = axis == 0 ? a % 3 - b % 3 : axis == 1 ? a / 3 % 3 - b / 3 % 3 : a / 9 - b / 9;
  return d < 0 ? -d : d;
}

/// Of each point of the neighbourhood the others of it whose distance along the axes sums to `reach` at most:
/// those that share a face (1), an edge (2) or a corner (3).
constexpr std::array<Neighbourhood, 27> neighbours(int reach) {
  std::array<Neighbourhood, 27> result{};
  for (int a = 0; a < 27; ++a)
    for (int b = 0; b < 27; ++b) {
      const int x = distance(a, b, 0), y = distance(a, b, 1), z = distance(a, b, 2);
      if (a != b && x <= 1 && y <= 1 && z <= 1 && x + y + z <= reach) result[a] |= 1u << b;
    }
  return result;
}

constexpr std::array<Neighbourhood, 27> kAcrossFaces = neighbours(1), kAcrossEdges = neighbours(2),
                                        kAcrossCorners = neighbours(3);
constexpr Neighbourhood kNearCentre = kAcrossEdges[kCentre];

/// The connected piece of the set that holds the bits of `piece`.
Neighbourhood grown(Neighbourhood piece, Neighbourhood set, const std::array<Neighbourhood, 27>& adjacent) {
  for (Neighbourhood front = piece; front != 0;) {
    Neighbourhood next = 0;
    for (; front != 0; front &= front - 1) next |= adjacent[std::countr_zero(front)];
    front = next & set & ~piece;
    piece |= front;
  }
  return piece;
}

/// Whether what of the set touches the centre in the given way is one piece within the set and `range`.
bool is_one(Neighbourhood set, const std::array<Neighbourhood, 27>& adjacent, Neighbourhood range) {
  const Neighbourhood touching = set & adjacent[kCentre] & kOthers;
  return touching != 0 && (touching & ~grown(touching & (~touching + 1), set & range, adjacent)) == 0;
}

/// Whether a change of the centre's side from or to the one keeps the pieces and handles of both, where `in`
/// is connected across corners or edges, and `out` across faces.
bool keeps_topology(Neighbourhood in, Neighbourhood out) {
  return is_one(in, kAcrossCorners, kOthers) && is_one(out, kAcrossFaces, kNearCentre) &&
         is_one(in, kAcrossEdges, kOthers) && is_one(out, kAcrossFaces, kOthers);
}

}  // namespace

bool is_simple(Neighbourhood inside) {
  const Neighbourhood in = inside & kOthers, out = ~inside & kOthers;
  return keeps_topology(in, out) && keeps_topology(out, in);
}

}  // namespace kappaflow
