// Typed reading of TOML: every value is checked where it is read, and every mistake names line, column and
// what is allowed.
#pragma once

#include <toml++/toml.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/errors.h"
#include "core/named.h"
#include "core/types.h"

namespace kappaflow {

/// The numbers that a key accepts; always finite.
struct NumberRange {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool without_lower = false;  ///< the lower end itself is not allowed
  std::string_view unit;       ///< shown in messages; empty: dimensionless

  bool contains(double x) const {
    return std::isfinite(x) && x <= upper && (without_lower ? x > lower : x >= lower);
  }
};

inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr NumberRange positive(std::string_view unit, double upper = kUnbounded) {
  return {0, upper, true, unit};
}
constexpr NumberRange non_negative(std::string_view unit, double upper = kUnbounded) {
  return {0, upper, false, unit};
}

/// A text file in memory. Throws InvalidInput when it is missing, no text file, or larger than 1 MiB.
std::string read_small_text_file(const std::filesystem::path& file);

/// Parses TOML. Throws InvalidInput with line and column at the first mistake in the syntax.
toml::table parse_toml(std::string_view text, const std::filesystem::path& file);

/// Both at once.
toml::table read_toml(const std::filesystem::path& file);

/// One table of a TOML document while it is read. Reading a key makes it an allowed one; finish() then
/// reports the keys that nobody read and the required ones that are missing. A value of the wrong type or out
/// of range is an InvalidInput at once. The document must outlive it.
class TomlTable {
 public:
  /// name: as messages show it, e.g. "[fluid]".
  TomlTable(const toml::table& table, std::string name, std::string file);

  // Without a fallback a key is required; where it is missing a placeholder is returned and finish() throws.
  // So misspelt keys, which finish() reports first, are not taken for missing ones.
  double number(std::string_view key, const NumberRange& range, std::optional<double> fallback = {});
  int integer(std::string_view key, int lower, int upper, std::optional<int> fallback = {});
  /// true or false.
  bool flag(std::string_view key, std::optional<bool> fallback = {});
  /// An array of whole numbers.
  std::vector<int> integers(std::string_view key, int lower, int upper, const std::vector<int>& fallback);
  Vec3 vector(std::string_view key, std::string_view unit, const std::optional<Vec3>& fallback = {});
  /// A number, or nothing where the string `word` stands in its place.
  std::optional<double> number_or(std::string_view word, std::string_view key, const NumberRange& range,
                                  std::optional<double> fallback);
  /// A string without control characters.
  std::string text(std::string_view key, const std::optional<std::string>& fallback = {});
  /// An array of numbers in the range.
  std::vector<double> numbers(std::string_view key, const NumberRange& range,
                              const std::vector<double>& fallback);
  /// An array of one or more such strings.
  std::vector<std::string> texts(std::string_view key);
  /// Which of `allowed` a string is. Precondition: has(key).
  std::size_t place(std::string_view key, std::span<const std::string_view> allowed) {
    return *name_index(key, allowed, true);
  }
  /// Distinct strings, each one of `allowed`.
  std::vector<std::string> names(std::string_view key, std::span<const std::string_view> allowed,
                                 const std::vector<std::string>& fallback);
  /// The value of one of the names. Without a fallback a missing key throws at once, since more keys depend
  /// on it.
  template <class T, std::size_t N>
  T choice(std::string_view key, const Named<T> (&values)[N], const std::optional<T>& fallback = {});

  /// The table [key]; an empty one where it is missing and not required.
  TomlTable table(std::string_view key, bool required = false);
  /// The tables [[key]], in the order of the file; none where it is missing and not required.
  std::vector<TomlTable> tables(std::string_view key, bool required = false);

  /// A value in time, as an array of rows [time, value ...] of numbers in place of the value: times from 0 s
  /// on and ascending, `width` values each in `range`. Nothing where the key has anything but an array of
  /// arrays. allowed: the rows as messages describe them.
  std::vector<std::vector<double>> rows(std::string_view key, std::size_t width, const NumberRange& range,
                                        std::string_view allowed);

  bool has(std::string_view key) { return find(key) != nullptr; }
  SourcePosition where() const;
  SourcePosition where(std::string_view key) const;

  /// Throws InvalidInput for an unknown key (with the nearest allowed one), then for a missing one.
  void finish() const;

  /// Throws InvalidInput "KEY in [TABLE] is FOUND; allowed: ALLOWED" at the key's value, which must be there.
  [[noreturn]] void refuse(std::string_view key, std::string_view allowed) const;

 private:
  const toml::node* find(std::string_view key);
  const toml::node* find(std::string_view key, bool required, std::string_view allowed);
  std::string child_name(std::string_view key) const;
  [[noreturn]] void refuse(std::string_view key, const toml::node& value, std::string_view allowed) const;
  std::optional<std::size_t> name_index(std::string_view key, std::span<const std::string_view> allowed,
                                        bool required);

  const toml::table* table_;
  std::string name_, file_;
  std::vector<std::string> known_;
  std::string first_missing_;  // its message; empty: none
};

template <class T, std::size_t N>
T TomlTable::choice(std::string_view key, const Named<T> (&values)[N], const std::optional<T>& fallback) {
  std::vector<std::string_view> names;
  for (const Named<T>& v : values) names.push_back(v.name);
  const auto index = name_index(key, names, !fallback);
  return index ? values[*index].value : fallback.value_or(values[0].value);
}

}  // namespace kappaflow
