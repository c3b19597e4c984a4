#include "core/text_scanner.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/errors.h"
#include "core/parse_number.h"

namespace kappaflow {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

}  // namespace

std::string one_line(std::string_view text, std::size_t bytes) {
  std::string out;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool starts_character = (byte & 0xC0) != 0x80;  // of UTF-8
    if (out.size() >= bytes && starts_character) return out + "...";
    if (c == '\n')
      out += "\\n";
    else if (byte < 0x20 || byte == 0x7F)
      out += fmt::format("\\x{:02x}", byte);
    else
      out += c;
  }
  return out;
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

bool TextScanner::next_line() {
  if (rest_.empty()) return false;
  const std::size_t end = std::min(rest_.find('\n'), rest_.size());
  line_ = rest_.substr(0, end);
  rest_.remove_prefix(std::min(end + 1, rest_.size()));
  ++line_number_;
  return true;
}

std::string_view TextScanner::next_word() {
  line_.remove_prefix(std::min(line_.find_first_not_of(kBlanks), line_.size()));
  const std::size_t end = std::min(line_.find_first_of(kBlanks), line_.size());
  const std::string_view word = line_.substr(0, end);
  line_.remove_prefix(end);
  return word;
}

double TextScanner::next_number() {
  const std::string_view word = next_word();
  const auto number = parse_number<double>(without_plus(word));
  if (!number) fail(fmt::format("found \"{}\" where a number is needed", one_line(word, 30)));
  return *number;
}

Vec3 TextScanner::next_vector() {
  Vec3 v;
  for (double& component : v) component = next_number();
  return v;
}

void TextScanner::fail(std::string_view message) const {
  throw InvalidInput(fmt::format("has a mistake in line {}: {}", line_number_, message));
}

}  // namespace kappaflow
