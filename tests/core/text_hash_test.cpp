#include "core/text_hash.h"

#include <gtest/gtest.h>

#include <vector>

namespace kappaflow {
namespace {

// Test vectors of Fowler, Noll and Vo (the IETF draft "The FNV Non-Cryptographic Hash Algorithm").
TEST(TextHash, IsFnv1a) {
  EXPECT_EQ(text_hash(""), "fnv1a64:cbf29ce484222325");
  EXPECT_EQ(text_hash("a"), "fnv1a64:af63dc4c8601ec8c");
  EXPECT_EQ(text_hash("foobar"), "fnv1a64:85944171f73967e8");
}

TEST(TextHash, OfPartsIsThatOfTheWhole) {
  EXPECT_EQ(TextHash().add("foo").add("").add("bar").text(), text_hash("foobar"));
}

TEST(TextHash, IsOfAllNumbersAndOfHowTheyAreDivided) {
  const std::vector<int> numbers{1, 2, 3};
  const auto hash_of = [](std::span<const int> first, std::span<const int> second) {
    return TextHash().add_values(first).add_values(second).text();
  };
  const std::span<const int> all(numbers);
  EXPECT_NE(hash_of(all.first(1), all.last(2)), hash_of(all.first(2), all.last(1)));
  EXPECT_EQ(hash_of(all, {}), hash_of(numbers, {}));
}

}  // namespace
}  // namespace kappaflow
