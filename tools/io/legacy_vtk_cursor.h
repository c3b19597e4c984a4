// The words and numbers of legacy VTK files.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/io/point_data.h"

namespace kappaflow {

/// The words, lines and numbers of the file, one after the other. Trusts nothing in it, and throws
/// InvalidInput.
class LegacyCursor {
 public:
  explicit LegacyCursor(std::string_view bytes) : rest_(bytes) {}

  void set_binary(bool binary) { binary_ = binary; }
  bool binary() const { return binary_; }

  std::string_view line();
  /// Empty at the end of the file.
  std::string_view word();
  std::string_view needed_word(std::string_view what);
  std::size_t count(std::string_view what);
  double number(std::string_view what) { return number_from(needed_word(what)); }
  /// What an array holds, in lower case.
  std::string type();
  NumberType number_type();
  /// tuples x components numbers of what `what` names.
  std::vector<double> numbers(NumberType type, std::size_t tuples, std::size_t components,
                              std::string_view what);
  /// The same; none of an array of strings or variants, which is passed over.
  std::optional<std::vector<double>> values(const std::string& type, std::size_t tuples,
                                            std::size_t components, std::string_view what);
  /// What METADATA says of an array: up to an empty line, which names of components may have among them.
  void skip_metadata(std::size_t components);
  bool next_word_is(std::string_view keyword) const;

 private:
  std::string_view cut(std::size_t bytes);
  /// Of numbers or texts that the rest of the file can hold: a bit at least for each.
  std::size_t checked_product(std::size_t tuples, std::size_t components, std::string_view what) const;
  /// Its length stands before it: the first two bits tell in how many bytes, big-endian.
  void skip_binary_string(std::string_view what);

  std::string_view rest_;
  bool binary_ = false;
};

}  // namespace kappaflow
