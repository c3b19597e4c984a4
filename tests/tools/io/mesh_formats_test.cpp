// What OBJ and PLY files hold beside the triangles, which far_mesh_test.cpp reads back.
#include "tools/io/mesh_formats.h"

#include <cstring>
#include <string>

#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

const std::vector<Vec3> kPosition{{0, 0, 0}, {1.5, 0, 0}, {0, 1, 0}};
const std::vector<Vec3> kNormal{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
const std::vector<Vec2> kTexture{{0, 0}, {1, 0}, {0, 1}, {0.25, 0.75}};
const std::vector<Rgb> kColour{{0, 0, 0}, {255, 255, 255}, {188, 10, 55}};
const std::vector<Triangle> kTriangles{{0, 1, 2}}, kCorners{{0, 3, 2}};

TEST(Obj, ACornerHasItsOwnTextureCoordinates) {
  const std::string text =
      mesh_bytes(MeshFormat::obj, {kPosition, kNormal, kTexture, kColour, kTriangles, kCorners});
  EXPECT_NE(text.find("\nvt 0.25 0.75\n"), std::string::npos);
  EXPECT_NE(text.find("\nf 1/1/1 2/4/2 3/3/3\n"), std::string::npos) << text;
  const std::string plain = mesh_bytes(MeshFormat::obj, {kPosition, kNormal, kTexture, kColour, kTriangles});
  EXPECT_NE(plain.find("\nf 1/1/1 2/2/2 3/3/3\n"), std::string::npos) << plain;
}

TEST(Ply, HoldsAllArrays) {
  const std::vector<PointArray> arrays{{"velocity", 3, {1, 2, 3, 4, 5, 6, 7, 8, 9}, NumberType::float32},
                                       {"rest", 3, {0.1, 2, 3, 4, 5, 6, 7, 8, 9.7}, NumberType::float64},
                                       {"id", 1, {5, 6, 2147483648.0 + 7}, NumberType::int64},
                                       {"unprojected", 1, {0, 1, 0}, NumberType::uint8},
                                       {"stress", 6, std::vector<double>(18, 2.5), NumberType::float32}};
  const std::string bytes =
      mesh_bytes(MeshFormat::ply, {kPosition, kNormal, kTexture, kColour, kTriangles, kCorners, arrays});
  const std::string end = "end_header\n";
  const std::size_t body = bytes.find(end) + end.size();
  const std::string header = bytes.substr(0, body);
  for (const char* property : {"float velocity_x", "float velocity_z", "double rest_y", "int id",
                               "uchar unprojected", "float stress_0", "float stress_5"})
    EXPECT_NE(header.find(fmt::format("\nproperty {}\n", property)), std::string::npos) << property;
  constexpr std::size_t kPlain = 3 * 8 + 3 * 4 + 2 * 4 + 3, kVertex = kPlain + 3 * 4 + 3 * 8 + 4 + 1 + 6 * 4;
  ASSERT_EQ(bytes.size(), body + 3 * kVertex + 1 + 3 * 4);
  const std::size_t last = body + 2 * kVertex + kPlain;
  const auto number = [&](auto value, std::size_t at) {
    std::memcpy(&value, bytes.data() + last + at, sizeof value);
    return value;
  };
  EXPECT_EQ(number(0.f, 0), 7);
  EXPECT_EQ(number(0.0, 12 + 16), 9.7);
  EXPECT_EQ(number(0, 36), 7) << "modulo 2^31";
  EXPECT_EQ(bytes[last - kVertex + 40], 1);
  EXPECT_EQ(number(0.f, 41 + 20), 2.5f);
}

}  // namespace
}  // namespace kappaflow
