// numpy arrays into and out of the libraries' vectors. Nothing is copied on the way out.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/types.h"

namespace kappaflow::python {

namespace nb = nanobind;

/// What the package's Python half hands over: C-contiguous arrays of one row an entry, whose shapes and types
/// it has seen to.
template <class Scalar, nb::ssize_t... Rest>
using ArrayIn = nb::ndarray<const Scalar, nb::shape<-1, Rest...>, nb::c_contig, nb::device::cpu>;
using VectorsIn = ArrayIn<double, 3>;
using NumbersIn = ArrayIn<double>;
using IdsIn = ArrayIn<std::int64_t>;
using IntegersIn = ArrayIn<int>;
using TrianglesIn = ArrayIn<int, 3>;

/// Its entries where they are, as long as the array lives.
template <class Entry, class Array>
std::span<const Entry> entries(const Array& array) {
  return {reinterpret_cast<const Entry*>(array.data()), array.shape(0)};
}

template <class Entry, class Array>
std::vector<Entry> copied(const Array& array) {
  const std::span<const Entry> values = entries<Entry>(array);
  return {values.begin(), values.end()};
}

template <class Scalar, nb::ssize_t... Rest>
using ArrayOut = nb::ndarray<nb::numpy, Scalar, nb::shape<-1, Rest...>>;
using VectorsOut = ArrayOut<double, 3>;
using NumbersOut = ArrayOut<double>;
using MatricesOut = ArrayOut<double, 3, 3>;

/// An array that owns what was the vector's. Rest: the shape of an entry.
template <class Scalar, nb::ssize_t... Rest, class Entry>
ArrayOut<Scalar, Rest...> array_of(std::vector<Entry> values) {
  static_assert(sizeof(Entry) == sizeof(Scalar) * (1 * ... * static_cast<std::size_t>(Rest)));
  auto vector = std::make_unique<std::vector<Entry>>(std::move(values));
  const nb::capsule owner(vector.get(), [](void* p) noexcept { delete static_cast<std::vector<Entry>*>(p); });
  const std::vector<Entry>& held = *vector.release();
  return ArrayOut<Scalar, Rest...>(const_cast<Entry*>(held.data()),
                                   {held.size(), static_cast<std::size_t>(Rest)...}, owner);
}

inline VectorsOut vectors_of(std::vector<Vec3> values) {
  return array_of<double, 3>(std::move(values));
}

/// Arrays by the names that files have them under.
using NamedArrays = nb::typed<nb::dict, nb::str, nb::ndarray<nb::numpy>>;

}  // namespace kappaflow::python
