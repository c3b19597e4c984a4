#include "scenes/toml_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/read_file.h"
#include "core/suggestion.h"
#include "core/text_scanner.h"

namespace kappaflow {
namespace {

constexpr std::size_t kMaxFileBytes = 1 << 20;
constexpr std::size_t kMaxShownBytes = 60;
constexpr std::size_t kMaxShownElements = 4;

bool is_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
}

std::string in_quotes(std::string_view text) {
  return fmt::format("\"{}\"", one_line(text, kMaxShownBytes));
}

std::string list_in_quotes(std::span<const std::string_view> names) {
  std::vector<std::string> parts;
  for (const std::string_view name : names) parts.push_back(in_quotes(name));
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::string describe(const toml::node& node) {
  if (const auto* s = node.as_string()) return in_quotes(s->get());
  if (const auto* i = node.as_integer()) return fmt::format("{}", i->get());
  if (const auto* x = node.as_floating_point()) return fmt::format("{}", x->get());
  if (const auto* b = node.as_boolean()) return b->get() ? "true" : "false";
  if (const auto* a = node.as_array()) {
    if (a->size() > kMaxShownElements) return fmt::format("an array of {} values", a->size());
    std::vector<std::string> elements;
    for (const toml::node& element : *a) elements.push_back(describe(element));
    return fmt::format("[{}]", fmt::join(elements, ", "));
  }
  if (node.is_table()) return "a table";
  return "a date or time";
}

std::string with_unit(std::string_view unit) {
  return unit.empty() ? "" : fmt::format(" [{}]", unit);
}

std::string describe(const NumberRange& range) {
  std::string text = "a number";
  if (std::isfinite(range.lower))
    text += fmt::format(" {} {}", range.without_lower ? ">" : ">=", range.lower);
  if (std::isfinite(range.upper))
    text += fmt::format("{} <= {}", std::isfinite(range.lower) ? " and" : "", range.upper);
  return text + with_unit(range.unit);
}

SourcePosition position(const std::string& file, const toml::source_region& region) {
  return {file, static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

}  // namespace

std::string read_small_text_file(const std::filesystem::path& file) {
  const SourcePosition where{file.string()};
  std::error_code ignored;  // a file that cannot be examined cannot be opened either, which is reported below
  if (!std::filesystem::exists(file, ignored))
    throw InvalidInput(where, "no such file; allowed: a scene file (.toml)");
  if (std::filesystem::is_directory(file, ignored))
    throw InvalidInput(where, "found a directory; allowed: a scene file (.toml)");
  std::string text;
  try {
    text = read_file(file, kMaxFileBytes + 1);
  } catch (const IoError&) {
    throw InvalidInput(where, "the file cannot be read; allowed: a readable scene file (.toml)");
  }
  if (text.size() > kMaxFileBytes)
    throw InvalidInput(
        where, fmt::format("the file is larger than {} bytes; allowed: a scene file (.toml)", kMaxFileBytes));
  return text;
}

toml::table parse_toml(std::string_view text, const std::filesystem::path& file) {
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw InvalidInput(position(file.string(), error.source()),
                       fmt::format("{}; allowed: TOML 1.0", one_line(error.description(), 200)));
  }
}

toml::table read_toml(const std::filesystem::path& file) {
  return parse_toml(read_small_text_file(file), file);
}

TomlTable::TomlTable(const toml::table& table, std::string name, std::string file)
    : table_(&table), name_(std::move(name)), file_(std::move(file)) {}

const toml::node* TomlTable::find(std::string_view key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
  return table_->get(key);
}

const toml::node* TomlTable::find(std::string_view key, bool required, std::string_view allowed) {
  const toml::node* node = find(key);
  if (!node && required && first_missing_.empty())
    first_missing_ = fmt::format("missing \"{}\" in {}; required: {}", key, name_, allowed);
  return node;
}

double TomlTable::number(std::string_view key, const NumberRange& range, std::optional<double> fallback) {
  const toml::node* node = find(key, !fallback, describe(range));
  if (!node) return fallback.value_or(0);
  const auto value = node->is_number() ? node->value<double>() : std::nullopt;
  if (!value || !range.contains(*value)) refuse(key, *node, describe(range));
  return *value;
}

int TomlTable::integer(std::string_view key, int lower, int upper, std::optional<int> fallback) {
  const std::string allowed = fmt::format("a whole number from {} to {}", lower, upper);
  const toml::node* node = find(key, !fallback, allowed);
  if (!node) return fallback.value_or(0);
  const auto* value = node->as_integer();
  if (!value || value->get() < lower || value->get() > upper) refuse(key, *node, allowed);
  return static_cast<int>(value->get());
}

bool TomlTable::flag(std::string_view key, std::optional<bool> fallback) {
  const toml::node* node = find(key, !fallback, "true or false");
  if (!node) return fallback.value_or(false);
  const auto* value = node->as_boolean();
  if (!value) refuse(key, *node, "true or false");
  return value->get();
}

Vec3 TomlTable::vector(std::string_view key, std::string_view unit, const std::optional<Vec3>& fallback) {
  const std::string allowed = "3 finite numbers, [x, y, z]" + with_unit(unit);
  const toml::node* node = find(key, !fallback, allowed);
  if (!node) return fallback.value_or(Vec3::Zero());
  const toml::array* array = node->as_array();
  if (!array || array->size() != 3) refuse(key, *node, allowed);
  Vec3 v;
  for (int a = 0; a < 3; ++a) {
    const toml::node& component = *array->get(static_cast<std::size_t>(a));
    v[a] = component.is_number() ? *component.value<double>() : std::nan("");
    if (!std::isfinite(v[a])) refuse(fmt::format("{}[{}]", key, a), component, allowed);
  }
  return v;
}

std::optional<double> TomlTable::number_or(std::string_view word, std::string_view key,
                                           const NumberRange& range, std::optional<double> fallback) {
  const toml::node* node = find(key);
  if (!node) return fallback;
  if (node->value<std::string_view>() == word) return std::nullopt;
  const auto value = node->is_number() ? node->value<double>() : std::nullopt;
  if (!value || !range.contains(*value))
    refuse(key, *node, fmt::format("\"{}\" or {}", word, describe(range)));
  return value;
}

std::string TomlTable::text(std::string_view key, const std::optional<std::string>& fallback) {
  const std::string_view allowed = "a string without control characters";
  const toml::node* node = find(key, !fallback, allowed);
  if (!node) return fallback.value_or("");
  const auto* value = node->as_string();
  if (!value || std::any_of(value->get().begin(), value->get().end(), is_control))
    refuse(key, *node, allowed);
  return value->get();
}

std::vector<std::string> TomlTable::texts(std::string_view key) {
  constexpr std::string_view allowed = "an array of strings";
  const toml::node* node = find(key, true, allowed);
  if (!node) return {""};
  const toml::array* array = node->as_array();
  if (!array || array->empty()) refuse(key, *node, allowed);
  std::vector<std::string> found;
  for (const toml::node& element : *array) {
    if (!element.is_string()) refuse(key, element, allowed);
    found.push_back(element.ref<std::string>());
  }
  return found;
}

std::vector<int> TomlTable::integers(std::string_view key, int lower, int upper,
                                     const std::vector<int>& fallback) {
  const toml::node* node = find(key);
  if (!node) return fallback;
  const std::string allowed = fmt::format("an array of whole numbers from {} to {}", lower, upper);
  const toml::array* array = node->as_array();
  if (!array || array->empty()) refuse(key, *node, allowed);
  std::vector<int> found;
  for (const toml::node& element : *array) {
    const auto* value = element.as_integer();
    if (!value || value->get() < lower || value->get() > upper) refuse(key, element, allowed);
    found.push_back(static_cast<int>(value->get()));
  }
  return found;
}

std::vector<double> TomlTable::numbers(std::string_view key, const NumberRange& range,
                                       const std::vector<double>& fallback) {
  const toml::node* node = find(key);
  if (!node) return fallback;
  const std::string allowed = "an array of one or more, each " + describe(range);
  const toml::array* array = node->as_array();
  if (!array || array->empty()) refuse(key, *node, allowed);
  std::vector<double> found;
  for (const toml::node& element : *array) {
    const auto value = element.is_number() ? element.value<double>() : std::nullopt;
    if (!value || !range.contains(*value)) refuse(key, element, allowed);
    found.push_back(*value);
  }
  return found;
}

std::vector<std::vector<double>> TomlTable::rows(std::string_view key, std::size_t width,
                                                 const NumberRange& range, std::string_view allowed) {
  const toml::node* node = find(key);
  const toml::array* array = node ? node->as_array() : nullptr;
  std::vector<std::vector<double>> found;
  if (!array || array->empty() || !array->front().is_array()) return found;
  for (const toml::node& element : *array) {
    const toml::array* row = element.as_array();
    if (!row || row->size() != 1 + width) refuse(key, element, allowed);
    std::vector<double> numbers;
    for (const toml::node& cell : *row) {
      const auto number = cell.is_number() ? cell.value<double>() : std::nullopt;
      const bool is_time = numbers.empty();
      const double least = found.empty() ? 0 : std::nextafter(found.back().front(), kUnbounded);
      if (!number ||
          !(is_time ? non_negative("s").contains(*number) && *number >= least : range.contains(*number)))
        refuse(key, cell, allowed);
      numbers.push_back(*number);
    }
    found.push_back(std::move(numbers));
  }
  return found;
}

std::vector<std::string> TomlTable::names(std::string_view key, std::span<const std::string_view> allowed,
                                          const std::vector<std::string>& fallback) {
  const toml::node* node = find(key);
  if (!node) return fallback;
  const std::string described = "an array of different names out of " + list_in_quotes(allowed);
  const toml::array* array = node->as_array();
  if (!array) refuse(key, *node, described);
  std::vector<std::string> found;
  for (const toml::node& element : *array) {
    const std::string name = element.value<std::string>().value_or("");
    if (std::find(allowed.begin(), allowed.end(), name) == allowed.end())
      refuse(key, element, described + suggestion(name, allowed));
    if (std::find(found.begin(), found.end(), name) != found.end())
      throw InvalidInput(
          position(file_, element.source()),
          fmt::format("{} in {} has {} twice; allowed: {}", key, name_, in_quotes(name), described));
    found.push_back(name);
  }
  return found;
}

std::optional<std::size_t> TomlTable::name_index(std::string_view key,
                                                 std::span<const std::string_view> allowed, bool required) {
  const std::string described = list_in_quotes(allowed);
  const toml::node* node = find(key);
  if (!node && required)
    throw InvalidInput(where(), fmt::format("missing \"{}\" in {}; required: {}", key, name_, described));
  if (!node) return std::nullopt;
  const std::string name = node->value<std::string>().value_or("");
  const auto match = std::find(allowed.begin(), allowed.end(), name);
  if (!node->is_string() || match == allowed.end()) refuse(key, *node, described + suggestion(name, allowed));
  return static_cast<std::size_t>(match - allowed.begin());
}

std::string TomlTable::child_name(std::string_view key) const {
  const std::size_t brackets = name_.find_first_not_of('[');  // 2 of an element of an array, 0 of the whole
  if (brackets == 0) return std::string(key);
  return fmt::format("{}.{}", name_.substr(brackets, name_.size() - 2 * brackets), key);
}

TomlTable TomlTable::table(std::string_view key, bool required) {
  static const toml::table empty;
  const std::string name = fmt::format("[{}]", child_name(key));
  const toml::node* node = find(key, required, "a table " + name);
  if (node && !node->is_table()) refuse(key, *node, "a table, " + name);
  return TomlTable(node ? *node->as_table() : empty, name, file_);
}

std::vector<TomlTable> TomlTable::tables(std::string_view key, bool required) {
  const std::string name = fmt::format("[[{}]]", child_name(key));
  const std::string allowed = "one or more tables " + name;
  const toml::node* node = find(key, required, allowed);
  std::vector<TomlTable> found;
  if (!node) return found;
  const toml::array* array = node->as_array();
  if (!array || (required && array->empty())) refuse(key, *node, allowed);
  for (const toml::node& element : *array) {
    if (!element.is_table()) refuse(key, element, allowed);
    found.emplace_back(*element.as_table(), name, file_);
  }
  return found;
}

SourcePosition TomlTable::where() const {
  return position(file_, table_->source());
}

SourcePosition TomlTable::where(std::string_view key) const {
  const toml::node* node = table_->get(key);
  return node ? position(file_, node->source()) : where();
}

void TomlTable::finish() const {
  const toml::key* unknown = nullptr;
  for (const auto& [key, value] : *table_) {
    if (std::find(known_.begin(), known_.end(), key.str()) != known_.end()) continue;
    if (!unknown || key.source().begin < unknown->source().begin) unknown = &key;
  }
  if (unknown) {
    const std::vector<std::string_view> names(known_.begin(), known_.end());
    throw InvalidInput(position(file_, unknown->source()),
                       fmt::format("unknown key {} in {}; allowed: {}{}", in_quotes(unknown->str()), name_,
                                   fmt::join(names, ", "), suggestion(unknown->str(), names)));
  }
  if (!first_missing_.empty()) throw InvalidInput(where(), first_missing_);
}

void TomlTable::refuse(std::string_view key, std::string_view allowed) const {
  refuse(key, *table_->get(key), allowed);
}

void TomlTable::refuse(std::string_view key, const toml::node& value, std::string_view allowed) const {
  throw InvalidInput(position(file_, value.source()),
                     fmt::format("{} in {} is {}; allowed: {}", key, name_, describe(value), allowed));
}

}  // namespace kappaflow
