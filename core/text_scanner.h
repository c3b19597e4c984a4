// Reading words and numbers from text, line by line.
#pragma once

#include <string>
#include <string_view>

#include "core/types.h"

namespace kappaflow {

/// Text from a file as part of a message: shortened to about `bytes`, without control characters.
std::string one_line(std::string_view text, std::size_t bytes);

/// With a to z for A to Z.
std::string lower_case(std::string_view text);

/// Goes through a text line by line, and through each line word by word. Lines end with \n or \r\n.
class TextScanner {
 public:
  explicit TextScanner(std::string_view text) : rest_(text) {}

  /// False at the end of the text.
  bool next_line();
  /// The next word of the line; empty at its end.
  std::string_view next_word();
  /// The next word as a number; throws as fail() does.
  double next_number();
  Vec3 next_vector();

  /// What follows the current line.
  std::string_view rest() const { return rest_; }
  /// Throws InvalidInput "has a mistake in line N: message".
  [[noreturn]] void fail(std::string_view message) const;

 private:
  std::string_view rest_, line_;
  int line_number_ = 0;
};

}  // namespace kappaflow
