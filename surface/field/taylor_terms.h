// Which coefficient of a polynomial in three variables is which, and how they combine in a product; known
// when the program is compiled.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace kappaflow::taylor {

using Exponents = std::array<int, 3>;

constexpr std::size_t count(int degree) {
  return static_cast<std::size_t>((degree + 1) * (degree + 2) * (degree + 3) / 6);
}

constexpr int degree_of(const Exponents& e) {
  return e[0] + e[1] + e[2];
}

/// By degree, then as ThirdDerivatives orders them: 1, x, y, z, xx, xy, ...; those of a lower degree are a
/// prefix.
constexpr std::array<Exponents, count(3)> exponents() {
  std::array<Exponents, count(3)> list{};
  std::size_t n = 0;
  for (int degree = 0; degree <= 3; ++degree)
    for (int x = degree; x >= 0; --x)
      for (int y = degree - x; y >= 0; --y) list[n++] = {x, y, degree - x - y};
  return list;
}
inline constexpr auto kExponents = exponents();

constexpr std::size_t index_of(const Exponents& e) {
  std::size_t i = 0;
  while (kExponents[i] != e) ++i;
  return i;
}

/// The pairs (i, j) whose terms make up coefficient k of a product of two polynomials whose terms below
/// degree A and B vanish.
template <int Degree, int A, int B, std::size_t K>
constexpr auto product_terms() {
  const auto visit = [](const auto& term) {
    for (std::size_t i = 0; i < count(Degree); ++i)
      for (std::size_t j = 0; j < count(Degree); ++j) {
        const Exponents &e = kExponents[i], &f = kExponents[j];
        if (degree_of(e) >= A && degree_of(f) >= B &&
            kExponents[K] == Exponents{e[0] + f[0], e[1] + f[1], e[2] + f[2]})
          term(i, j);
      }
  };
  constexpr std::size_t kTerms = [visit] {
    std::size_t n = 0;
    visit([&n](std::size_t, std::size_t) { ++n; });
    return n;
  }();
  std::array<std::pair<std::size_t, std::size_t>, kTerms> terms{};
  std::size_t n = 0;
  visit([&](std::size_t i, std::size_t j) { terms[n++] = {i, j}; });
  return terms;
}

}  // namespace kappaflow::taylor
