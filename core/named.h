// Names that users write, and what they stand for.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace kappaflow {

/// A name in a scene or on the command line, and the value that it stands for.
template <class T>
struct Named {
  std::string_view name;
  T value;
};

/// The name of a value that the table holds.
template <class T, std::size_t N>
constexpr std::string_view name_of(const Named<T> (&table)[N], T value) {
  std::size_t i = 0;
  while (table[i].value != value) ++i;
  return table[i].name;
}

/// The value of a name; nullopt where the table does not have it.
template <class T, std::size_t N>
constexpr std::optional<T> value_of(const Named<T> (&table)[N], std::string_view name) {
  for (const Named<T>& named : table)
    if (named.name == name) return named.value;
  return std::nullopt;
}

}  // namespace kappaflow
