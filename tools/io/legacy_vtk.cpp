// "VTK File Formats", the legacy ones, versions 1.0 to 5.1: https://docs.vtk.org/en/latest/design_documents/
#include "tools/io/legacy_vtk.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/errors.h"
#include "core/named.h"
#include "core/parse_number.h"
#include "core/text_scanner.h"

namespace kappaflow {
namespace {

constexpr std::string_view kBlanks = " \t\r\n\v\f";

NumberType number_type_named(const std::string& name) {
  static constexpr Named<NumberType> kTypes[] = {
      {"bit", NumberType::bit},
      {"char", NumberType::int8},
      {"signed_char", NumberType::int8},
      {"unsigned_char", NumberType::uint8},
      {"short", NumberType::int16},
      {"unsigned_short", NumberType::uint16},
      {"int", NumberType::int32},
      {"unsigned_int", NumberType::uint32},
      {"long", NumberType::int64},
      {"unsigned_long", NumberType::uint64},
      {"vtktypeint64", NumberType::int64},
      {"vtktypeuint64", NumberType::uint64},
      {"vtkidtype", NumberType::int32},  // as VTK writes it, whatever its size in memory
      {"float", NumberType::float32},
      {"double", NumberType::float64}};
  for (const auto& known : kTypes)
    if (known.name == name) return known.value;
  throw InvalidInput(fmt::format("\"{}\" is no type of numbers", one_line(name, 30)));
}

/// The words, lines and numbers of the file, one after the other.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : rest_(bytes) {}

  void set_binary(bool binary) { binary_ = binary; }

  std::string_view line() {
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return line.substr(0, line.find_last_not_of(kBlanks) + 1);
  }
  /// Empty at the end of the file.
  std::string_view word() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size()));
    return cut(std::min(rest_.find_first_of(kBlanks), rest_.size()));
  }
  std::string_view needed_word(std::string_view what) {
    const std::string_view found = word();
    if (found.empty()) throw InvalidInput(fmt::format("ends before {}", what));
    return found;
  }
  std::size_t count(std::string_view what) {
    const std::string_view found = needed_word(what);
    if (const auto count = parse_number<std::size_t>(found)) return *count;
    throw InvalidInput(fmt::format("{} is \"{}\"; expected a whole number >= 0", what, one_line(found, 30)));
  }
  /// What an array holds, in lower case.
  std::string type() { return lower_case(needed_word("the type of its numbers")); }
  NumberType number_type() { return number_type_named(type()); }
  /// tuples x components numbers of what `what` names.
  std::vector<double> numbers(NumberType type, std::size_t tuples, std::size_t components,
                              std::string_view what) {
    const std::size_t count = checked_product(tuples, components, what);
    std::vector<double> values;
    if (binary_) {
      line();  // to the end of the line that says how many there are
      if (bytes_of(type, count) > rest_.size()) throw_short(what, tuples, components);
      values = binary_numbers(cut(bytes_of(type, count)), type, std::endian::big);
      values.resize(count);  // bits fill bytes
      return values;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const std::string_view found = word();
      if (found.empty()) throw_short(what, tuples, components);
      values.push_back(number_from(found));
    }
    return values;
  }
  /// The same; none of an array of strings or variants, which is passed over.
  std::optional<std::vector<double>> values(const std::string& type, std::size_t tuples,
                                            std::size_t components, std::string_view what) {
    const bool strings = type == "string" || type == "utf8_string";
    if (!strings && type != "variant") return numbers(number_type_named(type), tuples, components, what);
    line();
    for (std::size_t left = checked_product(tuples, components, what); left > 0; --left) {
      if (rest_.empty()) throw_in_texts(what);
      if (strings && binary_)
        skip_binary_string(what);
      else
        line();  // variants are text in all files
    }
    return std::nullopt;
  }
  /// What METADATA says of an array: up to an empty line, which names of components may have among them.
  void skip_metadata(std::size_t components) {
    line();
    while (!rest_.empty()) {
      const std::string keyword = lower_case(line());
      if (keyword.empty()) return;
      if (keyword != "component_names") continue;
      for (std::size_t c = 0; c < components && !rest_.empty(); ++c) line();
    }
  }

  bool binary() const { return binary_; }
  bool next_word_is(std::string_view keyword) const { return lower_case(Cursor(*this).word()) == keyword; }

 private:
  std::string_view cut(std::size_t bytes) {
    const std::string_view found = rest_.substr(0, bytes);
    rest_.remove_prefix(bytes);
    return found;
  }
  /// Of numbers or texts that the rest of the file can hold: a bit at least for each.
  std::size_t checked_product(std::size_t tuples, std::size_t components, std::string_view what) const {
    if (components != 0 && tuples > 8 * rest_.size() / components) throw_short(what, tuples, components);
    return tuples * components;
  }
  /// Its length stands before it: the first two bits tell in how many bytes, big-endian.
  void skip_binary_string(std::string_view what) {
    const auto first = static_cast<unsigned char>(rest_[0]);
    const std::size_t bytes = std::size_t{8} >> (first >> 6);
    std::uint64_t length = first & 0x3F;
    for (std::size_t i = 1; i < std::min(bytes, rest_.size()); ++i)
      length = length << 8 | static_cast<unsigned char>(rest_[i]);
    if (bytes > rest_.size() || length > rest_.size() - bytes) throw_in_texts(what);
    cut(bytes + length);
  }
  [[noreturn]] static void throw_in_texts(std::string_view what) {
    throw InvalidInput(fmt::format("ends in the texts of {}", one_line(what, 30)));
  }
  [[noreturn]] static void throw_short(std::string_view what, std::size_t tuples, std::size_t components) {
    throw InvalidInput(
        fmt::format("ends before the {} x {} numbers of {}", tuples, components, one_line(what, 30)));
  }

  std::string_view rest_;
  bool binary_ = false;
};

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
  explicit LegacyReader(std::string_view bytes) : in_(bytes) {}

  PointData read() {
    read_head();
    for (std::string_view word = in_.word(); !word.empty(); word = in_.word()) read_section(word);
    data_.check_sizes();
    return std::move(data_);
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
      skip_cells(word);
    else if (keyword == "cell_types")
      in_.numbers(NumberType::int32, in_.count("the number of cells"), 1, word);
    else if (keyword == "point_data")
      begin_point_data();
    else if (keyword == "cell_data")
      owner_ = Owner::cells, tuples_ = in_.count("the number of cells");
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
    if (kind != "polydata" && kind != "unstructured_grid")
      throw InvalidInput(fmt::format("holds {}; expected POLYDATA or UNSTRUCTURED_GRID", one_line(kind, 30)));
  }

  void read_points() {
    const std::size_t count = in_.count("the number of points");
    const NumberType type = in_.number_type();
    components_ = 3;
    const std::vector<double> values = in_.numbers(type, count, components_, "POINTS");
    for (std::size_t i = 0; i < values.size(); i += 3)
      data_.position.emplace_back(values[i], values[i + 1], values[i + 2]);
  }

  /// Up to version 5.0 cells and numbers, as many as said; then the two arrays of version 5.1.
  void skip_cells(std::string_view section) {
    const std::size_t first = in_.count("the number of cells"), second = in_.count("the size of the cells");
    if (!in_.next_word_is("offsets")) {
      in_.numbers(NumberType::int32, second, 1, section);
      return;
    }
    for (const std::size_t count : {first, second}) {
      const std::string_view name = in_.needed_word("OFFSETS and CONNECTIVITY");
      in_.numbers(in_.number_type(), count, 1, name);
    }
  }

  void begin_point_data() {
    owner_ = Owner::points;
    tuples_ = in_.count("the number of points with data");
    if (tuples_ != data_.position.size())
      throw InvalidInput(
          fmt::format("POINT_DATA are of {} points; there are {}", tuples_, data_.position.size()));
  }

  /// The array that comes next, which goes where it belongs.
  void read_array(std::string_view name, const std::string& type, std::size_t tuples,
                  std::size_t components) {
    components_ = components;
    std::optional<std::vector<double>> values = in_.values(type, tuples, components, name);
    if (!values || owner_ == Owner::cells) return;
    (owner_ == Owner::points ? data_.arrays : data_.fields)
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

  Cursor in_;
  PointData data_;
  Owner owner_ = Owner::file;
  std::size_t tuples_ = 0;      // of the owner's arrays
  std::size_t components_ = 0;  // of the array that was read last
};

}  // namespace

PointData parse_legacy_vtk(std::string_view bytes) {
  return LegacyReader(bytes).read();
}

}  // namespace kappaflow
