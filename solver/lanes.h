// Eight numbers at a time, and four: sums over lanes and changes of their order, without a detour by memory.
#pragma once

#include <array>
#include <cstring>

#include "core/wide.h"

namespace kappaflow {

/// (sum of x, sum of y, sum of z, 0)
inline Vec4f sums(const Wide& x, const Wide& y, const Wide& z) {
  using Four [[gnu::vector_size(16)]] = float;
  using Eight [[gnu::vector_size(32)]] = float;
  const auto read = [](const Wide& lanes) {
    Eight eight;
    std::memcpy(&eight, lanes.data(), sizeof eight);
    return eight;
  };
  const auto folded = [](const Eight& a, const Eight& b) {  // a, b, a, b in either half
    return __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13) +
           __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  };
  const Eight xy = folded(read(x), read(y)), zo = folded(read(z), Eight{});
  const Eight both = __builtin_shufflevector(xy, zo, 0, 1, 8, 9, 4, 5, 12, 13) +
                     __builtin_shufflevector(xy, zo, 2, 3, 10, 11, 6, 7, 14, 15);
  const Four sum =
      __builtin_shufflevector(both, both, 0, 1, 2, 3) + __builtin_shufflevector(both, both, 4, 5, 6, 7);
  Vec4f result;
  std::memcpy(result.data(), &sum, sizeof sum);
  return result;
}

/// (v[a], v[b], v[c], v[d])
template <int a, int b, int c, int d>
Vec4f shuffled(const Vec4f& v) {
  using Four [[gnu::vector_size(16)]] = float;
  Four four;
  std::memcpy(&four, v.data(), sizeof four);
  four = __builtin_shufflevector(four, four, a, b, c, d);
  Vec4f result;
  std::memcpy(result.data(), &four, sizeof four);
  return result;
}

/// a x b of padded vectors.
inline Vec4f cross(const Vec4f& a, const Vec4f& b) {
  return shuffled<1, 2, 0, 3>(a.cwiseProduct(shuffled<1, 2, 0, 3>(b)) -
                              shuffled<1, 2, 0, 3>(a).cwiseProduct(b));
}

}  // namespace kappaflow
