#include "tools/pictures/surface_packer.h"

#include <gtest/gtest.h>

namespace kappaflow {
namespace {

std::string bytes(std::initializer_list<int> values) {
  std::string result;
  for (const int value : values) result += static_cast<char>(value);
  return result;
}

// Two frames by hand, as the header describes them.
TEST(SurfacePacker, WritesWhatHasChanged) {
  SurfacePacker packer;
  EXPECT_EQ(
      packer.pack({{7, 8, 9, 10}, {{2, {256, 255, 255, 0}}, {1, {0, 255, 255, 3}}}, {{2, 0, 1}, {3, 1, 2}}}),
      bytes({4, 0, 0, 0,   2, 0, 0, 0,     // vertices and triangles: all are new
             0, 1, 0, 253, 2, 0, 0, 1,     // +256, -1, 0, -255: lowest bytes, then those above
             0, 1, 0, 8,                   // 0, -1 around the end, 0, +4
             0, 1, 0, 0,   0, 0, 0, 0,     // triangles 0 1 2 and 1 2 3: first corners 0, +1
             1, 1, 0, 0,   0, 0, 0, 0,     // second corners: first + 1
             2, 2, 0, 0,   0, 0, 0, 0}));  // third corners: first + 2
  // Vertex 8 is gone, 11 is new, and the file has another order: written are 7, 9, 10, 11.
  EXPECT_EQ(
      packer.pack({{11, 7, 9, 10}, {{2, {5, 257, 255, 0}}, {1, {3, 0, 255, 3}}}, {{2, 3, 0}, {3, 2, 1}}}),
      bytes({4,      0, 0, 0,  2, 0, 0, 0,  //
             0b1101, 0,  // those that stay; of the triangles, which both had vertex 8, none
             2,      0, 0, 10, 0, 0, 0, 0,  // +1, 0, 0 to the last frame, +5 to the vertex before
             0,      0, 0, 0,               //
             0,      1, 0, 0,  0, 0, 0, 0,  // triangles 0 2 1 and 1 2 3
             2,      1, 0, 0,  0, 0, 0, 0,  //
             1,      2, 0, 0,  0, 0, 0, 0}));
  EXPECT_EQ(
      packer.pack({{7, 9, 10, 11}, {{2, {257, 255, 0, 5}}, {1, {0, 255, 3, 3}}}, {{2, 1, 0}, {1, 2, 3}}}),
      bytes({4, 0, 0, 0, 0, 0, 0, 0, 0b1111, 0b11, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}))
      << "nothing has changed";
}

TEST(Base64, HasTheVectorsOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

}  // namespace
}  // namespace kappaflow
