// Text as HTML has it.
#pragma once

#include <string>
#include <string_view>

namespace kappaflow {

/// With what is markup in elements and attributes written as what it looks like.
inline std::string html_text(std::string_view text) {
  std::string result;
  for (const char c : text)
    result += c == '&'   ? "&amp;"
              : c == '<' ? "&lt;"
              : c == '>' ? "&gt;"
              : c == '"' ? "&quot;"
                         : std::string(1, c);
  return result;
}

}  // namespace kappaflow
