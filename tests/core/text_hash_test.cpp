#include "core/text_hash.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace kappaflow
