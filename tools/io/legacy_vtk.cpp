// "VTK File Formats", the legacy ones, versions 1.0 to 5.1: https://docs.vtk.org/en/latest/design_documents/
#include "tools/io/legacy_vtk.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.h"
#include "core/named.h"
#include "core/text_scanner.h"
#include "tools/io/legacy_vtk_cursor.h"

namespace kappaflow {
namespace {

/// Array names stand for blanks and the like as URLs do: %20.
std::string decoded(std::string_view name) {
  std::string result;
  for (std::size_t i = 0; i < name.size(); ++i) {
    unsigned char code = 0;
    if (name[i] == '%' && i + 2 < name.size() &&
        std::from_chars(&name[i + 1], &name[i + 3], code, 16).ptr == &name[i + 3]) {
      result += static_cast<char>(code);
      i += 2;
    } else {
      result += name[i];
    }
  }
  return result;
}

/// Reads the sections of a file, which may come in any order.
class LegacyReader {
 public:
  /// kinds: of data sets that will do. Of cells' arrays those of images are kept.
  LegacyReader(std::string_view bytes, std::vector<std::string_view> kinds, bool with_polygons = false)
      : in_(bytes), kinds_(std::move(kinds)), with_polygons_(with_polygons) {}

  void read() {
    read_head();
    for (std::string_view word = in_.word(); !word.empty(); word = in_.word()) read_section(word);
  }

  PointData points() {
    data_.check_sizes();
    return std::move(data_);
  }
  LatticeData image() {
    image_.arrays = std::move(data_.arrays);
    image_.cell_arrays = std::move(cell_arrays_);
    image_.fields = std::move(data_.fields);
    image_.check_sizes();
    return std::move(image_);
  }
  /// Those that were kept; in the order of the file.
  PolygonList polygons() {
    for (const int corner : polygons_.corner) checked_corner(corner, data_.position.size());
    return std::move(polygons_);
  }

 private:
  enum class Owner { file, points, cells };

  void read_head() {
    if (!in_.line().starts_with("# vtk DataFile Version "))
      throw InvalidInput("does not begin with # vtk DataFile Version");
    in_.line();  // the title
    const std::string format = lower_case(in_.needed_word("ASCII or BINARY"));
    if (format != "ascii" && format != "binary")
      throw InvalidInput(fmt::format("its format is \"{}\"; expected ASCII or BINARY", one_line(format, 30)));
    in_.set_binary(format == "binary");
  }

  void read_section(std::string_view word) {
    const std::string keyword = lower_case(word);
    if (keyword == "dataset")
      read_kind();
    else if (keyword == "points")
      read_points();
    else if (keyword == "vertices" || keyword == "lines" || keyword == "polygons" ||
             keyword == "triangle_strips" || keyword == "cells")
      read_cells(word, keyword);
    else if (keyword == "dimensions")
      read_dimensions();
    else if (keyword == "origin")
      image_.origin = vector(word);
    else if (keyword == "spacing" || keyword == "aspect_ratio")
      image_.spacing = vector(word);
    else if (keyword == "cell_types")
      in_.numbers(NumberType::int32, in_.count("the number of cells"), 1, word);
    else if (keyword == "point_data")
      begin_point_data();
    else if (keyword == "cell_data")
      owner_ = Owner::cells, tuples_ = in_.count("the number of cells with data");
    else if (keyword == "metadata")
      in_.skip_metadata(components_);
    else if (keyword == "field")
      read_field();
    else if (owner_ != Owner::file)
      read_attribute(word, keyword);
    else
      throw InvalidInput(fmt::format("found \"{}\" where a section begins", one_line(word, 30)));
  }

  void read_kind() {
    const std::string kind = lower_case(in_.needed_word("the kind of its data set"));
    const auto is_kind = [&](std::string_view known) { return lower_case(known) == kind; };
    if (std::ranges::none_of(kinds_, is_kind))
      throw InvalidInput(fmt::format("holds {}; expected {}", one_line(kind, 30), fmt::join(kinds_, " or ")));
  }

  void read_points() {
    const std::size_t count = in_.count("the number of points");
    const NumberType type = in_.number_type();
    components_ = 3;
    const std::vector<double> values = in_.numbers(type, count, components_, "POINTS");
    for (std::size_t i = 0; i < values.size(); i += 3)
      data_.position.emplace_back(values[i], values[i + 1], values[i + 2]);
  }

  Vec3 vector(std::string_view what) {
    const double x = in_.number(what), y = in_.number(what), z = in_.number(what);
    return {x, y, z};
  }

  void read_dimensions() {
    constexpr std::size_t kMost = 1'000'000'000'000;
    for (std::size_t& points : image_.points) points = in_.count("DIMENSIONS");
    std::size_t left = kMost;
    for (const std::size_t points : image_.points) {
      if (points == 0 || points > left)
        throw InvalidInput(fmt::format("DIMENSIONS are {}", fmt::join(image_.points, " ")));
      left /= points;
    }
  }

  /// Up to version 5.0 cells and numbers, as many as said; then the two arrays of version 5.1.
  void read_cells(std::string_view section, const std::string& keyword) {
    const std::size_t first = in_.count("the number of cells"), second = in_.count("the size of the cells");
    std::vector<std::vector<double>> numbers;
    if (!in_.next_word_is("offsets")) {
      numbers.push_back(in_.numbers(NumberType::int32, second, 1, section));
    } else {
      for (const std::size_t count : {first, second}) {
        const std::string_view name = in_.needed_word("OFFSETS and CONNECTIVITY");
        numbers.push_back(in_.numbers(in_.number_type(), count, 1, name));
      }
    }
    const bool strips = keyword == "triangle_strips";
    if (with_polygons_ && (strips || keyword == "polygons")) keep_polygons(numbers, strips);
  }

  /// numbers: of each polygon how many corners it has, and these; or where the polygons begin, and the
  /// corners.
  void keep_polygons(const std::vector<std::vector<double>>& numbers, bool strips) {
    constexpr std::size_t kMost = std::numeric_limits<int>::max();
    const std::vector<double>& corners = numbers.back();
    const bool counted = numbers.size() == 1;
    std::size_t at = 0, polygon = 0;
    std::vector<int> corner;
    while (counted ? at < corners.size() : polygon + 1 < numbers[0].size()) {
      const double count = counted ? corners[at++] : numbers[0][polygon + 1] - numbers[0][polygon];
      ++polygon;
      if (!(count >= 0 && count <= static_cast<double>(corners.size() - at)) || count != std::floor(count))
        throw InvalidInput(
            fmt::format("has a polygon of {} corners; {} are left", count, corners.size() - at));
      corner.clear();
      for (std::size_t c = 0; c < static_cast<std::size_t>(count); ++c)
        corner.push_back(checked_corner(corners[at++], kMost));
      if (strips) {
        add_strip(corner, polygons_);
      } else {
        polygons_.corner.insert(polygons_.corner.end(), corner.begin(), corner.end());
        polygons_.end.push_back(polygons_.corner.size());
      }
    }
  }

  void begin_point_data() {
    owner_ = Owner::points;
    tuples_ = in_.count("the number of points with data");
    const auto& [nx, ny, nz] = image_.points;
    const std::size_t points = is_image() ? nx * ny * nz : data_.position.size();
    if (tuples_ != points)
      throw InvalidInput(fmt::format("POINT_DATA are of {} points; there are {}", tuples_, points));
  }

  bool is_image() const { return image_.points[0] > 0; }

  /// The array that comes next, which goes where it belongs.
  void read_array(std::string_view name, const std::string& type, std::size_t tuples,
                  std::size_t components) {
    components_ = components;
    std::optional<std::vector<double>> values = in_.values(type, tuples, components, name);
    if (!values || (owner_ == Owner::cells && !is_image())) return;
    (owner_ == Owner::points  ? data_.arrays
     : owner_ == Owner::cells ? cell_arrays_
                              : data_.fields)
        .push_back({decoded(name), components, std::move(*values)});
  }

  void read_field() {
    in_.needed_word("the name of a field");
    for (std::size_t left = in_.count("the number of arrays"); left > 0; --left) {
      std::string_view name = in_.needed_word("the arrays of a field");
      while (lower_case(name) == "metadata") {
        in_.skip_metadata(components_);
        name = in_.needed_word("the arrays of a field");
      }
      if (name == "NULL_ARRAY") continue;  // VTK's word for an array that is not there
      const std::size_t components = in_.count("the number of components"),
                        tuples = in_.count("the number of tuples");
      read_array(name, in_.type(), tuples, components);
    }
  }

  /// An array that begins with the keyword; the number of its components and its type are read where they
  /// come after the name.
  void read_attribute(std::string_view word, const std::string& keyword) {
    const std::string_view name = in_.needed_word("the name of an array");
    const std::string colour = in_.binary() ? "unsigned_char" : "float";
    if (keyword == "lookup_table") {
      in_.values(colour, in_.count("the size of a lookup table"), 4, name);
    } else if (keyword == "color_scalars") {
      const std::size_t components = in_.count("the number of components");
      read_array(name, colour, tuples_, components);
    } else if (keyword == "texture_coordinates") {
      const std::size_t components = in_.count("the number of components");
      read_array(name, in_.type(), tuples_, components);
    } else {
      const std::size_t components = components_of(word, keyword);
      const std::string type = in_.type();
      read_array(name, type, tuples_, keyword == "scalars" ? read_rest_of_scalars() : components);
    }
  }

  static std::size_t components_of(std::string_view word, const std::string& keyword) {
    static constexpr Named<std::size_t> kComponents[] = {
        {"scalars", 1},  {"vectors", 3},    {"normals", 3},      {"tensors", 9},
        {"tensors6", 6}, {"global_ids", 1}, {"pedigree_ids", 1}, {"edge_flags", 1}};
    for (const auto& known : kComponents)
      if (known.name == keyword) return known.value;
    throw InvalidInput(fmt::format("found \"{}\" where a section or an array begins", one_line(word, 30)));
  }

  /// The number of components, which may be left out, and the name of the lookup table.
  std::size_t read_rest_of_scalars() {
    const std::size_t components =
        in_.next_word_is("lookup_table") ? 1 : in_.count("the number of components");
    if (lower_case(in_.needed_word("LOOKUP_TABLE")) != "lookup_table")
      throw InvalidInput("SCALARS without LOOKUP_TABLE after them");
    in_.needed_word("the name of the lookup table");
    return components;
  }

  LegacyCursor in_;
  std::vector<std::string_view> kinds_;
  bool with_polygons_;
  PointData data_;
  std::vector<PointArray> cell_arrays_;
  LatticeData image_;
  PolygonList polygons_;
  Owner owner_ = Owner::file;
  std::size_t tuples_ = 0;      // of the owner's arrays
  std::size_t components_ = 0;  // of the array that was read last
};

}  // namespace

PointData parse_legacy_vtk(std::string_view bytes) {
  LegacyReader reader(bytes, {"POLYDATA", "UNSTRUCTURED_GRID"});
  reader.read();
  return reader.points();
}

VtkPolygons parse_legacy_polygons(std::string_view bytes) {
  LegacyReader reader(bytes, {"POLYDATA"}, true);
  reader.read();
  PolygonList polygons = reader.polygons();
  return {reader.points(), std::move(polygons), {}};
}

LatticeData parse_legacy_image(std::string_view bytes) {
  LegacyReader reader(bytes, {"STRUCTURED_POINTS"});
  reader.read();
  return reader.image();
}

}  // namespace kappaflow
