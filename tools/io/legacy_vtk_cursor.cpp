#include "tools/io/legacy_vtk_cursor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "core/errors.h"
#include "core/named.h"
#include "core/parse_number.h"
#include "core/text_scanner.h"

namespace kappaflow {
namespace {

constexpr std::string_view kBlanks = " \t\r\n\v\f";

NumberType number_type_named(const std::string& name) {
  static constexpr Named<NumberType> kTypes[] = {
      {"bit", NumberType::bit},
      {"char", NumberType::int8},
      {"signed_char", NumberType::int8},
      {"unsigned_char", NumberType::uint8},
      {"short", NumberType::int16},
      {"unsigned_short", NumberType::uint16},
      {"int", NumberType::int32},
      {"unsigned_int", NumberType::uint32},
      {"long", NumberType::int64},
      {"unsigned_long", NumberType::uint64},
      {"vtktypeint64", NumberType::int64},
      {"vtktypeuint64", NumberType::uint64},
      {"vtkidtype", NumberType::int32},  // as VTK writes it, whatever its size in memory
      {"float", NumberType::float32},
      {"double", NumberType::float64}};
  for (const auto& known : kTypes)
    if (known.name == name) return known.value;
  throw InvalidInput(fmt::format("\"{}\" is no type of numbers", one_line(name, 30)));
}

[[noreturn]] void throw_in_texts(std::string_view what) {
  throw InvalidInput(fmt::format("ends in the texts of {}", one_line(what, 30)));
}

[[noreturn]] void throw_short(std::string_view what, std::size_t tuples, std::size_t components) {
  throw InvalidInput(
      fmt::format("ends before the {} x {} numbers of {}", tuples, components, one_line(what, 30)));
}

}  // namespace

std::string_view LegacyCursor::line() {
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  const std::string_view line = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  return line.substr(0, line.find_last_not_of(kBlanks) + 1);
}

std::string_view LegacyCursor::word() {
  rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size()));
  return cut(std::min(rest_.find_first_of(kBlanks), rest_.size()));
}

std::string_view LegacyCursor::needed_word(std::string_view what) {
  const std::string_view found = word();
  if (found.empty()) throw InvalidInput(fmt::format("ends before {}", what));
  return found;
}

std::size_t LegacyCursor::count(std::string_view what) {
  const std::string_view found = needed_word(what);
  if (const auto count = parse_number<std::size_t>(found)) return *count;
  throw InvalidInput(fmt::format("{} is \"{}\"; expected a whole number >= 0", what, one_line(found, 30)));
}

std::string LegacyCursor::type() {
  return lower_case(needed_word("the type of its numbers"));
}

NumberType LegacyCursor::number_type() {
  return number_type_named(type());
}

std::vector<double> LegacyCursor::numbers(NumberType type, std::size_t tuples, std::size_t components,
                                          std::string_view what) {
  const std::size_t count = checked_product(tuples, components, what);
  std::vector<double> values;
  if (binary_) {
    line();  // to the end of the line that says how many there are
    if (bytes_of(type, count) > rest_.size()) throw_short(what, tuples, components);
    values = binary_numbers(cut(bytes_of(type, count)), type, std::endian::big);
    values.resize(count);  // bits fill bytes
    return values;
  }
  values.reserve(std::min(count, rest_.size() / 2 + 1));  // a digit and a blank for each, at least
  for (std::size_t i = 0; i < count; ++i) {
    const std::string_view found = word();
    if (found.empty()) throw_short(what, tuples, components);
    values.push_back(number_from(found));
  }
  return values;
}

std::optional<std::vector<double>> LegacyCursor::values(const std::string& type, std::size_t tuples,
                                                        std::size_t components, std::string_view what) {
  const bool strings = type == "string" || type == "utf8_string";
  if (!strings && type != "variant") return numbers(number_type_named(type), tuples, components, what);
  line();
  for (std::size_t left = checked_product(tuples, components, what); left > 0; --left) {
    if (rest_.empty()) throw_in_texts(what);
    if (strings && binary_)
      skip_binary_string(what);
    else
      line();  // variants are text in all files
  }
  return std::nullopt;
}

void LegacyCursor::skip_metadata(std::size_t components) {
  line();
  while (!rest_.empty()) {
    const std::string keyword = lower_case(line());
    if (keyword.empty()) return;
    if (keyword != "component_names") continue;
    for (std::size_t c = 0; c < components && !rest_.empty(); ++c) line();
  }
}

bool LegacyCursor::next_word_is(std::string_view keyword) const {
  return lower_case(LegacyCursor(*this).word()) == keyword;
}

std::string_view LegacyCursor::cut(std::size_t bytes) {
  const std::string_view found = rest_.substr(0, bytes);
  rest_.remove_prefix(bytes);
  return found;
}

std::size_t LegacyCursor::checked_product(std::size_t tuples, std::size_t components,
                                          std::string_view what) const {
  if (components != 0 && tuples > 8 * rest_.size() / components) throw_short(what, tuples, components);
  return tuples * components;
}

void LegacyCursor::skip_binary_string(std::string_view what) {
  const auto first = static_cast<unsigned char>(rest_[0]);
  const std::size_t bytes = std::size_t{8} >> (first >> 6);
  std::uint64_t length = first & 0x3F;
  for (std::size_t i = 1; i < std::min(bytes, rest_.size()); ++i)
    length = length << 8 | static_cast<unsigned char>(rest_[i]);
  if (bytes > rest_.size() || length > rest_.size() - bytes) throw_in_texts(what);
  cut(bytes + length);
}

}  // namespace kappaflow
