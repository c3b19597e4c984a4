#include "tools/runs/run_record.h"

#include <gtest/gtest.h>

namespace kappaflow {
namespace {

// Test vectors of Fowler, Noll and Vo (the IETF draft "The FNV Non-Cryptographic Hash Algorithm").
TEST(TextHash, IsFnv1a) {
  EXPECT_EQ(text_hash(""), "fnv1a64:cbf29ce484222325");
  EXPECT_EQ(text_hash("a"), "fnv1a64:af63dc4c8601ec8c");
  EXPECT_EQ(text_hash("foobar"), "fnv1a64:85944171f73967e8");
}

TEST(BuildDescription, NamesTheLibraries) {
  const std::string text = build_description();
  for (const char* part : {"compiler ", " build\n", "VTK 9.", "Eigen 3.", "oneTBB 20"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
}

}  // namespace
}  // namespace kappaflow
