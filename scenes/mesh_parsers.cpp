#include "scenes/mesh_parsers.h"

#include <fmt/format.h>

#include <cstring>
#include <limits>

#include "core/errors.h"
#include "core/parse_number.h"
#include "core/text_scanner.h"

namespace kappaflow {
namespace {

constexpr std::size_t kStlHeader = 84, kStlTriangle = 50;

template <class T>
T stl_value(std::string_view bytes, std::size_t offset) {
  T value;  // STL is little-endian, as are the processors that this builds for
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

int checked_count(std::size_t points) {
  if (points > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw InvalidInput("has more points than can be numbered");
  return static_cast<int>(points);
}

void add_triangle_of_last_points(PolygonMesh& mesh) {
  const int n = checked_count(mesh.points.size());
  mesh.polygons.push_back({n - 3, n - 2, n - 1});
}

PolygonMesh parse_binary_stl(std::string_view bytes, std::size_t triangles) {
  PolygonMesh mesh;
  for (std::size_t t = 0; t < triangles; ++t) {
    const std::size_t corners = kStlHeader + t * kStlTriangle + 3 * sizeof(float);  // after the normal
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 x;
      for (std::size_t a = 0; a < 3; ++a)
        x[static_cast<int>(a)] = stl_value<float>(bytes, corners + (3 * k + a) * sizeof(float));
      mesh.points.push_back(x);
    }
    add_triangle_of_last_points(mesh);
  }
  return mesh;
}

PolygonMesh parse_ascii_stl(std::string_view text) {
  PolygonMesh mesh;
  bool ended = false;
  int corners = 0;
  for (TextScanner scanner(text); scanner.next_line();) {
    const std::string_view word = scanner.next_word();
    if (word == "vertex") {
      mesh.points.push_back(scanner.next_vector());
      ++corners;
    } else if (word == "endloop") {
      if (corners != 3) scanner.fail(fmt::format("a facet has {} corners instead of 3", corners));
      add_triangle_of_last_points(mesh);
      corners = 0;
    }
    ended = word == "endsolid" || (ended && word.empty());
  }
  if (!ended) throw InvalidInput("is truncated: it does not end with endsolid");
  return mesh;
}

/// The number from 0 of the point that the word of a face line names: "7", "7/1", "7/1/3", "7//3", or counted
/// back from the last: "-1".
int obj_index(TextScanner& scanner, std::string_view word, std::size_t points) {
  const long index = parse_number<long>(word.substr(0, word.find('/'))).value_or(0);
  const long count = checked_count(points);
  if (index == 0 || index > count || index < -count)
    scanner.fail(fmt::format("a face names point \"{}\"; there are {} before it", one_line(word, 30), count));
  return static_cast<int>(index > 0 ? index - 1 : count + index);
}

}  // namespace

PolygonMesh parse_stl(std::string_view bytes) {
  const std::size_t triangles =
      bytes.size() < kStlHeader ? 0 : stl_value<std::uint32_t>(bytes, kStlHeader - 4);
  if (bytes.size() >= kStlHeader && bytes.size() == kStlHeader + triangles * kStlTriangle)
    return parse_binary_stl(bytes, triangles);
  if (bytes.starts_with("solid")) return parse_ascii_stl(bytes);
  throw InvalidInput(
      fmt::format("is truncated or no STL: it has {} bytes, and as binary STL of {} triangles it needs {}",
                  bytes.size(), triangles, kStlHeader + triangles * kStlTriangle));
}

PolygonMesh parse_obj(std::string_view text) {
  PolygonMesh mesh;
  for (TextScanner scanner(text); scanner.next_line();) {
    const std::string_view command = scanner.next_word();
    if (command == "v") mesh.points.push_back(scanner.next_vector());
    if (command != "f") continue;
    std::vector<int> polygon;
    for (std::string_view word = scanner.next_word(); !word.empty(); word = scanner.next_word())
      polygon.push_back(obj_index(scanner, word, mesh.points.size()));
    if (polygon.size() < 3)
      scanner.fail(fmt::format("a face has {} corners; it needs 3 or more", polygon.size()));
    mesh.polygons.push_back(std::move(polygon));
  }
  return mesh;
}

}  // namespace kappaflow
