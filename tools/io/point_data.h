// Points with named arrays of numbers, as particle files of several formats hold them.
#pragma once

#include <bit>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"

namespace kappaflow {

enum class NumberType { bit, int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

struct PointArray {
  std::string name;
  std::size_t components = 1;
  std::vector<double> values;             ///< components numbers a tuple; whole ones are exact below 2^53
  NumberType type = NumberType::float64;  ///< in the file, where its reader says so
};

struct PointData {
  std::vector<Vec3> position;
  std::vector<PointArray> arrays;  ///< a tuple a point
  std::vector<PointArray> fields;  ///< numbers of the whole file

  /// Throws InvalidInput where an array does not have one tuple a point.
  void check_sizes() const;
};

/// The first array with one of the names, given in lower case, and as many components; null where there is
/// none.
const PointArray* find_array(const std::vector<PointArray>& arrays,
                             std::initializer_list<std::string_view> names, std::size_t components);

/// How many bytes `count` numbers take. Bits are packed.
std::size_t bytes_of(NumberType type, std::size_t count);

/// The numbers in binary data; of bits, eight for each byte.
std::vector<double> binary_numbers(std::string_view bytes, NumberType type, std::endian order);

/// The number that a word is, nan and inf included. Throws InvalidInput.
double number_from(std::string_view word);

}  // namespace kappaflow
