// Eight numbers at a time: what the SPH loops over neighbours are written in. Eigen's fixed arrays do the
// arithmetic (AVX2 with the baseline x86-64-v3, pairs of four lanes elsewhere); here is what Eigen lacks.
#pragma once

#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "core/types.h"

namespace kappaflow {

inline constexpr int kWide = 8;  ///< lanes

using Wide = Eigen::Array<float, kWide, 1>;
using WideDouble = Eigen::Array<double, kWide, 1>;

/// The same numbers as the compiler's own vector.
using Four [[gnu::vector_size(16)]] = float;
using Eight [[gnu::vector_size(32)]] = float;
using EightInts [[gnu::vector_size(32)]] = std::int32_t;

inline Eight eight_of(const Wide& lanes) {
  Eight eight;
  std::memcpy(&eight, lanes.data(), sizeof eight);
  return eight;
}

inline Wide wide_of(const Eight& eight) {
  Wide lanes;
  std::memcpy(lanes.data(), &eight, sizeof eight);
  return lanes;
}

/// Lane k is values[order[k]]; order in [0, 8).
inline EightInts permuted(const EightInts& values, const EightInts& order) {
#ifdef __AVX2__
  return reinterpret_cast<EightInts>(
      _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(values), reinterpret_cast<__m256i>(order)));
#else
  EightInts result;
  for (int lane = 0; lane < kWide; ++lane) result[lane] = values[order[lane]];
  return result;
#endif
}

/// Eight padded vectors, transposed.
struct WideVec {
  Wide x, y, z, w;
};

/// The eight vectors points[index[0]], points[index[1]], ...
inline WideVec gather(const Vec4f* points, const std::uint16_t* index) {
  const auto both = [&](int k) {  // points k and k + 4
    Four low, high;
    std::memcpy(&low, points[index[k]].data(), sizeof low);
    std::memcpy(&high, points[index[k + 4]].data(), sizeof high);
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
  };
  const Eight a = both(0), b = both(1), c = both(2), d = both(3);
  const Eight ab_xy = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  const Eight cd_xy = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
  const Eight ab_zw = __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15);
  const Eight cd_zw = __builtin_shufflevector(c, d, 2, 10, 3, 11, 6, 14, 7, 15);
  const Eight x = __builtin_shufflevector(ab_xy, cd_xy, 0, 1, 8, 9, 4, 5, 12, 13);
  const Eight y = __builtin_shufflevector(ab_xy, cd_xy, 2, 3, 10, 11, 6, 7, 14, 15);
  const Eight z = __builtin_shufflevector(ab_zw, cd_zw, 0, 1, 8, 9, 4, 5, 12, 13);
  const Eight w = __builtin_shufflevector(ab_zw, cd_zw, 2, 3, 10, 11, 6, 7, 14, 15);
  return {wide_of(x), wide_of(y), wide_of(z), wide_of(w)};
}

/// Eight 16-bit numbers as floats.
inline Wide widen(const std::uint16_t* values) {
  using Short [[gnu::vector_size(16)]] = std::uint16_t;
  Short narrow;
  std::memcpy(&narrow, values, sizeof narrow);
  return wide_of(__builtin_convertvector(__builtin_convertvector(narrow, EightInts), Eight));
}

/// The whole parts of eight numbers in [0, 65536).
inline void narrow(const Wide& values, std::uint16_t* out) {
  using Short [[gnu::vector_size(16)]] = std::uint16_t;
  const Short narrow = __builtin_convertvector(__builtin_convertvector(eight_of(values), EightInts), Short);
  std::memcpy(out, &narrow, sizeof narrow);
}

#ifdef __AVX2__
namespace detail {
/// For each set of lanes the order that brings them to the front.
inline constexpr auto kPacking = [] {
  std::array<std::array<std::uint32_t, kWide>, 256> packing{};
  for (std::uint32_t lanes = 0; lanes < 256; ++lanes)
    for (std::uint32_t lane = 0, packed = 0; lane < kWide; ++lane)
      if (lanes >> lane & 1) packing[lanes][packed++] = lane;
  return packing;
}();
}  // namespace detail
#endif

/// The lanes where it is true, as bits.
inline unsigned lanes_of(const EightInts& truth) {
#ifdef __AVX2__
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(__m256i(truth))));
#else
  unsigned lanes = 0;
  for (unsigned lane = 0; lane < kWide; ++lane) lanes |= static_cast<unsigned>(truth[lane] != 0) << lane;
  return lanes;
#endif
}

/// The lanes that are below the limit, as bits.
inline unsigned lanes_below(const WideDouble& values, double limit) {
#ifdef __AVX2__
  const __m256d limits = _mm256_set1_pd(limit);
  const auto half = [&](int first) {
    return static_cast<unsigned>(
        _mm256_movemask_pd(_mm256_cmp_pd(_mm256_loadu_pd(values.data() + first), limits, _CMP_LT_OQ)));
  };
  return half(0) | half(kWide / 2) << kWide / 2;
#else
  unsigned lanes = 0;
  for (unsigned lane = 0; lane < kWide; ++lane) lanes |= static_cast<unsigned>(values[lane] < limit) << lane;
  return lanes;
#endif
}

/// k, k + 1, ...
inline EightInts indices_from(std::uint32_t k) {
  return static_cast<std::int32_t>(k) + EightInts{0, 1, 2, 3, 4, 5, 6, 7};
}

/// Writes those of the eight values whose lanes are set to the front of `out`, in order. There is room for
/// eight. T: Eight or EightInts, and Number a number of as many bits as theirs.
template <class T, class Number>
void pack(const T& values, unsigned lanes, Number* out) {
  static_assert(sizeof(Number) == 4);
#ifdef __AVX2__
  const __m256i order = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(detail::kPacking[lanes].data()));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), _mm256_permutevar8x32_epi32(__m256i(values), order));
#else
  std::array<Number, kWide> numbers;
  std::memcpy(numbers.data(), &values, sizeof numbers);
  for (unsigned lane = 0; lane < kWide; ++lane)
    if (lanes >> lane & 1) *out++ = numbers[lane];
#endif
}

/// Writes to the front of `value_out` and `index_out` those of the eight values that are below `limit` and
/// whose index is not `except`, and their indices, in order; returns how many. Both have room for eight.
inline int pack_below(const Wide& value, const std::uint32_t* index, float limit, std::uint32_t except,
                      float* value_out, std::uint32_t* index_out) {
  EightInts indices;
  std::memcpy(&indices, index, sizeof indices);
  const unsigned lanes = lanes_of((eight_of(value) < limit) & (indices != static_cast<std::int32_t>(except)));
  pack(eight_of(value), lanes, value_out);
  pack(indices, lanes, index_out);
  return std::popcount(lanes);
}

}  // namespace kappaflow
