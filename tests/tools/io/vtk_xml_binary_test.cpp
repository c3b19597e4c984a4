#include "tools/io/vtk_xml_binary.h"

#include <gtest/gtest.h>

#include <string>

#include "core/errors.h"

namespace kappaflow {
namespace {

std::vector<double> floats(const std::string& text) {
  return encoded_numbers(text, true, NumberType::float32, {});
}

// Eight bytes, 1 and -2, with their number padded by itself and in one with them.
constexpr const char* kApart = "CAAAAA==AACAPwAAAMA=";
constexpr const char* kTogether = "CAAAAAAAgD8AAADA";

TEST(VtkXmlBinary, Base64MayBeBrokenAnywhere) {
  const std::vector<double> expected{1, -2};
  for (const std::string text : {kApart, kTogether})
    for (std::size_t at = 0; at <= text.size(); ++at)
      for (const char* blank : {"\n", "  ", "\r\n\t"}) {
        EXPECT_EQ(floats(text.substr(0, at) + blank + text.substr(at)), expected) << text << " at " << at;
        EXPECT_EQ(floats(text.substr(0, at) + blank + text.substr(at) + "AAAA"), expected);
      }
}

TEST(VtkXmlBinary, Base64ThatEndsEarlyOrHasOtherCharactersIsAnError) {
  for (const std::string text : {kApart, kTogether})
    for (std::size_t at = 0; at < text.size(); ++at) {
      EXPECT_THROW(floats(text.substr(0, at)), InvalidInput) << text << " to " << at;
      for (const char other : {'!', '\xc3', '-'}) {
        std::string damaged = text;
        damaged[at] = other;
        EXPECT_THROW(floats(damaged), InvalidInput) << damaged;
      }
    }
}

}  // namespace
}  // namespace kappaflow
