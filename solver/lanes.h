// Eight numbers at a time, and four: sums over lanes and changes of their order, without a detour by memory.
#pragma once

#include <array>
#include <cstring>

#include "core/wide.h"

namespace kappaflow {

/// (sum of x, sum of y, sum of z, 0)
inline Vec4f sums(const Wide& x, const Wide& y, const Wide& z) {
  const auto folded = [](const Eight& a, const Eight& b) {  // a, b, a, b in either half
    return __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13) +
           __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  };
  const Eight xy = folded(eight_of(x), eight_of(y)), zo = folded(eight_of(z), Eight{});
  const Eight both = __builtin_shufflevector(xy, zo, 0, 1, 8, 9, 4, 5, 12, 13) +
                     __builtin_shufflevector(xy, zo, 2, 3, 10, 11, 6, 7, 14, 15);
  const Four sum =
      __builtin_shufflevector(both, both, 0, 1, 2, 3) + __builtin_shufflevector(both, both, 4, 5, 6, 7);
  Vec4f result;
  std::memcpy(result.data(), &sum, sizeof sum);
  return result;
}

/// Rows to columns: row k becomes the k-th of each.
[[gnu::always_inline]] inline void transpose(std::array<Eight, 8>& rows) {
  std::array<Eight, 8> pairs;
  for (std::size_t k = 0; k < 8; k += 2) {
    pairs[k] = __builtin_shufflevector(rows[k], rows[k + 1], 0, 8, 1, 9, 4, 12, 5, 13);
    pairs[k + 1] = __builtin_shufflevector(rows[k], rows[k + 1], 2, 10, 3, 11, 6, 14, 7, 15);
  }
  for (std::size_t k : {0, 1, 4, 5}) {
    const std::size_t to = k / 4 * 4 + k % 4 * 2;
    rows[to] = __builtin_shufflevector(pairs[k], pairs[k + 2], 0, 1, 8, 9, 4, 5, 12, 13);
    rows[to + 1] = __builtin_shufflevector(pairs[k], pairs[k + 2], 2, 3, 10, 11, 6, 7, 14, 15);
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const Eight low = rows[k], high = rows[k + 4];
    rows[k] = __builtin_shufflevector(low, high, 0, 1, 2, 3, 8, 9, 10, 11);
    rows[k + 4] = __builtin_shufflevector(low, high, 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

/// (v[a], v[b], v[c], v[d])
template <int a, int b, int c, int d>
Vec4f shuffled(const Vec4f& v) {
  Four four;
  std::memcpy(&four, v.data(), sizeof four);
  four = __builtin_shufflevector(four, four, a, b, c, d);
  Vec4f result;
  std::memcpy(result.data(), &four, sizeof four);
  return result;
}

/// (v[a], v[b], v[c], v[d]), v the eight numbers of `low` and `high`
template <int a, int b, int c, int d>
Vec4f shuffled(const Vec4f& low, const Vec4f& high) {
  Four first, second;
  std::memcpy(&first, low.data(), sizeof first);
  std::memcpy(&second, high.data(), sizeof second);
  first = __builtin_shufflevector(first, second, a, b, c, d);
  Vec4f result;
  std::memcpy(result.data(), &first, sizeof first);
  return result;
}

/// (v[0], v[1], v[2], 0)
inline Vec4f without_fourth(const Vec4f& v) {
  return shuffled<0, 1, 2, 7>(v, Vec4f::Zero());
}

/// a x b of padded vectors.
inline Vec4f cross(const Vec4f& a, const Vec4f& b) {
  return shuffled<1, 2, 0, 3>(a.cwiseProduct(shuffled<1, 2, 0, 3>(b)) -
                              shuffled<1, 2, 0, 3>(a).cwiseProduct(b));
}

}  // namespace kappaflow
