#include "tools/io/point_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "core/errors.h"
#include "core/parse_number.h"
#include "core/text_scanner.h"

namespace kappaflow {
namespace {

template <class Number>
std::vector<double> numbers(std::string_view bytes, std::endian order) {
  std::vector<double> result;
  result.reserve(bytes.size() / sizeof(Number));
  for (; bytes.size() >= sizeof(Number); bytes.remove_prefix(sizeof(Number))) {
    std::array<char, sizeof(Number)> raw;
    std::copy_n(bytes.begin(), sizeof(Number), raw.begin());
    if (order != std::endian::native) std::ranges::reverse(raw);
    Number number;
    std::memcpy(&number, raw.data(), sizeof(Number));
    result.push_back(static_cast<double>(number));
  }
  return result;
}

std::vector<double> bits(std::string_view bytes) {
  std::vector<double> result;
  for (const char byte : bytes)
    for (int bit = 7; bit >= 0; --bit) result.push_back((byte >> bit) & 1);
  return result;
}

void check_tuples(const std::vector<PointArray>& arrays, std::size_t tuples, const char* what) {
  for (const PointArray& array : arrays)
    if (array.values.size() != array.components * tuples)
      throw InvalidInput(fmt::format("array \"{}\" has {} numbers, and {} {} with {} each need {}",
                                     one_line(array.name, 30), array.values.size(), tuples, what,
                                     array.components, array.components * tuples));
}

}  // namespace

void PointData::check_sizes() const {
  check_tuples(arrays, position.size(), "points");
}

std::array<std::size_t, 3> LatticeData::cells() const {
  std::array<std::size_t, 3> cells = points;
  for (std::size_t& count : cells) count = std::max<std::size_t>(count, 2) - 1;
  return cells;
}

void LatticeData::check_sizes() const {
  check_tuples(arrays, points[0] * points[1] * points[2], "points");
  check_tuples(cell_arrays, cells()[0] * cells()[1] * cells()[2], "cells");
}

const PointArray* find_array(const std::vector<PointArray>& arrays,
                             std::initializer_list<std::string_view> names, std::size_t components) {
  for (const std::string_view name : names)
    for (const PointArray& array : arrays)
      if (array.components == components && lower_case(array.name) == name) return &array;
  return nullptr;
}

std::optional<double> time_in(const std::vector<PointArray>& fields) {
  const PointArray* time = find_array(fields, {"timevalue", "time"}, 1);
  return time == nullptr || time->values.empty() ? std::nullopt : std::optional(time->values[0]);
}

void add_strip(std::span<const int> strip, PolygonList& polygons) {
  for (std::size_t k = 2; k < strip.size(); ++k) {  // every other one turns the other way
    const bool odd = k % 2 == 1;
    polygons.corner.insert(polygons.corner.end(),
                           {strip[odd ? k - 1 : k - 2], strip[odd ? k - 2 : k - 1], strip[k]});
    polygons.end.push_back(polygons.corner.size());
  }
}

int checked_corner(double number, std::size_t points) {
  constexpr double kMost = std::numeric_limits<int>::max();
  if (!(number >= 0 && number < static_cast<double>(points) && number <= kMost) ||
      number != std::floor(number))
    throw InvalidInput(fmt::format("has a polygon with the corner {} of {} points", number, points));
  return static_cast<int>(number);
}

std::size_t bytes_of(NumberType type, std::size_t count) {
  switch (type) {
    case NumberType::bit:
      return count / 8 + (count % 8 != 0);
    case NumberType::int8:
    case NumberType::uint8:
      return count;
    case NumberType::int16:
    case NumberType::uint16:
      return 2 * count;
    case NumberType::int32:
    case NumberType::uint32:
    case NumberType::float32:
      return 4 * count;
    default:
      return 8 * count;
  }
}

std::vector<double> binary_numbers(std::string_view bytes, NumberType type, std::endian order) {
  switch (type) {
    case NumberType::bit:
      return bits(bytes);
    case NumberType::int8:
      return numbers<std::int8_t>(bytes, order);
    case NumberType::uint8:
      return numbers<std::uint8_t>(bytes, order);
    case NumberType::int16:
      return numbers<std::int16_t>(bytes, order);
    case NumberType::uint16:
      return numbers<std::uint16_t>(bytes, order);
    case NumberType::int32:
      return numbers<std::int32_t>(bytes, order);
    case NumberType::uint32:
      return numbers<std::uint32_t>(bytes, order);
    case NumberType::int64:
      return numbers<std::int64_t>(bytes, order);
    case NumberType::uint64:
      return numbers<std::uint64_t>(bytes, order);
    case NumberType::float32:
      return numbers<float>(bytes, order);
    default:
      return numbers<double>(bytes, order);
  }
}

double number_from(std::string_view word) {
  if (const auto number = parse_number<double>(without_plus(word))) return *number;
  throw InvalidInput(fmt::format("found \"{}\" where a number is needed", one_line(word, 30)));
}

}  // namespace kappaflow
