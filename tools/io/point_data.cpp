#include "tools/io/point_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

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

}  // namespace

void PointData::check_sizes() const {
  for (const PointArray& array : arrays)
    if (array.values.size() != array.components * position.size())
      throw InvalidInput(fmt::format("array \"{}\" has {} numbers, and {} points with {} each need {}",
                                     one_line(array.name, 30), array.values.size(), position.size(),
                                     array.components, array.components * position.size()));
}

const PointArray* find_array(const std::vector<PointArray>& arrays,
                             std::initializer_list<std::string_view> names, std::size_t components) {
  for (const std::string_view name : names)
    for (const PointArray& array : arrays)
      if (array.components == components && lower_case(array.name) == name) return &array;
  return nullptr;
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
