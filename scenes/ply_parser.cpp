// PLY 1.0: Turk, "The PLY polygon file format", 1994.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>

#include "core/errors.h"
#include "core/text_scanner.h"
#include "scenes/mesh_parsers.h"

namespace kappaflow {
namespace {

enum class Format { ascii, little_endian, big_endian };
enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string name;
  Type type = Type::int8;
  std::optional<Type> count_type;  // of a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::ascii;
  std::vector<Element> elements;
  std::string_view body;
};

Type parse_type(const TextScanner& scanner, std::string_view word) {
  static constexpr std::array<std::array<std::string_view, 2>, 8> kNames{{{"char", "int8"},
                                                                          {"uchar", "uint8"},
                                                                          {"short", "int16"},
                                                                          {"ushort", "uint16"},
                                                                          {"int", "int32"},
                                                                          {"uint", "uint32"},
                                                                          {"float", "float32"},
                                                                          {"double", "float64"}}};
  for (std::size_t type = 0; type < kNames.size(); ++type)
    if (word == kNames[type][0] || word == kNames[type][1]) return static_cast<Type>(type);
  scanner.fail(fmt::format("unknown type \"{}\"", one_line(word, 30)));
}

Format parse_format(const TextScanner& scanner, std::string_view word) {
  if (word == "ascii") return Format::ascii;
  if (word == "binary_little_endian") return Format::little_endian;
  if (word == "binary_big_endian") return Format::big_endian;
  scanner.fail(fmt::format("unknown format \"{}\"", one_line(word, 30)));
}

Property parse_property(TextScanner& scanner) {
  Property property;
  std::string_view word = scanner.next_word();
  if (word == "list") {
    property.count_type = parse_type(scanner, scanner.next_word());
    word = scanner.next_word();
  }
  property.type = parse_type(scanner, word);
  property.name = scanner.next_word();
  return property;
}

Header parse_header(std::string_view bytes) {
  TextScanner scanner(bytes);
  Header header;
  if (!scanner.next_line() || scanner.next_word() != "ply")
    throw InvalidInput("is no PLY: it does not begin with ply");
  while (scanner.next_line()) {
    const std::string_view word = scanner.next_word();
    if (word == "format") header.format = parse_format(scanner, scanner.next_word());
    if (word == "element") {
      Element element{std::string(scanner.next_word()), 0, {}};
      const double count = scanner.next_number();
      // Each takes a byte at least, which bounds what a damaged count can make us allocate.
      if (!(count >= 0 && count <= static_cast<double>(bytes.size()) && count == std::floor(count)))
        scanner.fail("more elements than the file has room for");
      element.count = static_cast<std::size_t>(count);
      header.elements.push_back(std::move(element));
    }
    if (word == "property") {
      if (header.elements.empty()) scanner.fail("a property before the first element");
      header.elements.back().properties.push_back(parse_property(scanner));
    }
    if (word == "end_header") {
      header.body = scanner.rest();
      return header;
    }
  }
  throw InvalidInput("is truncated: its header does not end");
}

/// The numbers after the header, one after the other.
class Body {
 public:
  explicit Body(const Header& header) : format_(header.format), bytes_(header.body), text_(header.body) {}

  double next(Type type) {
    switch (type) {
      case Type::int8:
        return value<std::int8_t>();
      case Type::uint8:
        return value<std::uint8_t>();
      case Type::int16:
        return value<std::int16_t>();
      case Type::uint16:
        return value<std::uint16_t>();
      case Type::int32:
        return value<std::int32_t>();
      case Type::uint32:
        return value<std::uint32_t>();
      case Type::float32:
        return value<float>();
      default:
        return value<double>();
    }
  }

  /// Each element stands on a line of its own in ASCII files.
  void next_element() {
    if (format_ == Format::ascii && !text_.next_line()) throw_truncated();
  }

 private:
  template <class T>
  double value() {
    if (format_ == Format::ascii) return text_.next_number();
    if (bytes_.size() < sizeof(T)) throw_truncated();
    std::array<char, sizeof(T)> buffer;
    std::copy_n(bytes_.begin(), sizeof(T), buffer.begin());
    bytes_.remove_prefix(sizeof(T));
    if (format_ == Format::big_endian) std::reverse(buffer.begin(), buffer.end());
    T value;
    std::memcpy(&value, buffer.data(), sizeof(T));
    return static_cast<double>(value);
  }
  [[noreturn]] static void throw_truncated() {
    throw InvalidInput("is truncated: it has fewer elements than its header says");
  }

  Format format_;
  std::string_view bytes_;
  TextScanner text_;
};

int checked_index(double index, std::size_t points) {
  if (!(index >= 0 && index < static_cast<double>(points) && index == std::floor(index)))
    throw InvalidInput(fmt::format("has a face that names point {}; there are {}", index, points));
  return static_cast<int>(index);
}

std::vector<double> read_list(Body& body, const Property& property) {
  const double count = body.next(*property.count_type);
  if (!(count >= 0 && count < 65536)) throw InvalidInput(fmt::format("has a list of {} values", count));
  std::vector<double> values(static_cast<std::size_t>(count));
  for (double& value : values) value = body.next(property.type);
  return values;
}

/// One element: its position, if it has one, and its list of indices.
struct Row {
  Vec3 position = Vec3::Constant(std::nan(""));
  std::vector<double> indices;
};

Row read_row(Body& body, const Element& element) {
  Row row;
  body.next_element();
  for (const Property& property : element.properties) {
    if (property.count_type) {
      std::vector<double> values = read_list(body, property);
      if (property.name == "vertex_indices" || property.name == "vertex_index")
        row.indices = std::move(values);
      continue;
    }
    const double value = body.next(property.type);
    for (int a = 0; a < 3; ++a)
      if (property.name == std::string_view("xyz").substr(static_cast<std::size_t>(a), 1))
        row.position[a] = value;
  }
  return row;
}

}  // namespace

PolygonMesh parse_ply(std::string_view bytes) {
  const Header header = parse_header(bytes);
  Body body(header);
  PolygonMesh mesh;
  for (const Element& element : header.elements)
    for (std::size_t i = 0; i < element.count; ++i) {
      const Row row = read_row(body, element);
      if (element.name == "vertex") mesh.points.push_back(row.position);
      if (element.name != "face") continue;
      std::vector<int> polygon;
      for (const double index : row.indices) polygon.push_back(checked_index(index, mesh.points.size()));
      if (polygon.size() < 3) throw InvalidInput(fmt::format("has a face of {} corners", polygon.size()));
      mesh.polygons.push_back(std::move(polygon));
    }
  return mesh;
}

}  // namespace kappaflow
