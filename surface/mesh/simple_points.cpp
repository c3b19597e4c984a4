#include "surface/mesh/simple_points.h"

#include <array>
#include <bit>
#include <cstdlib>

namespace kappaflow {
namespace {

constexpr int kCentre = 13;
constexpr Neighbourhood kOthers = ((1u << 27) - 1) & ~(1u << kCentre);

constexpr int distance(int a, int b, int axis) {
  const int d = axis == 0 ? a % 3 - b % 3 : axis == 1 ? a / 3 % 3 - b / 3 % 3 : a / 9 - b / 9;
  return d < 0 ? -d : d;
}

/// Of each point of the neighbourhood the others of it that share a corner at least, or a face.
constexpr std::array<Neighbourhood, 27> neighbours(bool across_faces_only) {
  std::array<Neighbourhood, 27> result{};
  for (int a = 0; a < 27; ++a)
    for (int b = 0; b < 27; ++b) {
      const int x = distance(a, b, 0), y = distance(a, b, 1), z = distance(a, b, 2);
      if (a != b && x <= 1 && y <= 1 && z <= 1 && (!across_faces_only || x + y + z == 1))
        result[a] |= 1u << b;
    }
  return result;
}

constexpr std::array<Neighbourhood, 27> kAcrossCorners = neighbours(false), kAcrossFaces = neighbours(true);

/// The centre's neighbours that share an edge or a face with it.
constexpr Neighbourhood near_centre() {
  Neighbourhood result = 0;
  for (int a = 0; a < 27; ++a)
    if (distance(a, kCentre, 0) + distance(a, kCentre, 1) + distance(a, kCentre, 2) < 3) result |= 1u << a;
  return result & kOthers;
}

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

/// Whether the set is one piece, connected across corners.
bool is_one_across_corners(Neighbourhood set) {
  return set != 0 && grown(set & (~set + 1), set, kAcrossCorners) == set;
}

/// Whether what of the set shares a face with the centre is, near the centre, one piece connected across
/// faces.
bool is_one_across_faces(Neighbourhood set) {
  const Neighbourhood touching = set & kAcrossFaces[kCentre];
  return touching != 0 &&
         (touching & ~grown(touching & (~touching + 1), set & near_centre(), kAcrossFaces)) == 0;
}

}  // namespace

bool is_simple(Neighbourhood inside) {
  const Neighbourhood in = inside & kOthers, out = ~inside & kOthers;
  return is_one_across_corners(in) && is_one_across_faces(out) && is_one_across_corners(out) &&
         is_one_across_faces(in);
}

}  // namespace kappaflow
