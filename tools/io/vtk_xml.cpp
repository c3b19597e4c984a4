// "VTK XML File Formats": https://docs.vtk.org/en/latest/design_documents/
#include "tools/io/vtk_xml.h"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "core/errors.h"
#include "core/named.h"
#include "core/parse_number.h"
#include "core/text_scanner.h"
#include "tools/io/vtk_xml_binary.h"
#include "tools/io/xml_parser.h"

namespace kappaflow {
namespace {

using Attributes = const XML_Char**;

std::size_t count_in(Attributes attributes, std::string_view name, std::optional<std::size_t> fallback = {}) {
  const std::string_view text = xml_attribute(attributes, name);
  if (text.empty() && fallback) return *fallback;
  if (const auto count = parse_number<std::size_t>(text)) return *count;
  throw InvalidInput(fmt::format("{} is \"{}\"; expected a whole number >= 0", name, one_line(text, 30)));
}

NumberType type_in(Attributes attributes) {
  static constexpr Named<NumberType> kTypes[] = {
      {"Int8", NumberType::int8},      {"UInt8", NumberType::uint8},   {"Int16", NumberType::int16},
      {"UInt16", NumberType::uint16},  {"Int32", NumberType::int32},   {"UInt32", NumberType::uint32},
      {"Int64", NumberType::int64},    {"UInt64", NumberType::uint64}, {"Float32", NumberType::float32},
      {"Float64", NumberType::float64}};
  const std::string_view name = xml_attribute(attributes, "type");
  if (const std::optional<NumberType> type = value_of(kTypes, name)) return *type;
  throw InvalidInput(fmt::format("\"{}\" is no type of numbers", one_line(name, 30)));
}

std::vector<double> numbers_in(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  std::vector<double> values;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
    if (text.empty()) return values;
    const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
    values.push_back(number_from(word));
    text.remove_prefix(word.size());
  }
}

/// The part after the XML, which need not be well-formed.
struct AppendedData {
  std::string_view bytes;
  bool base64 = false;
};

/// Hears of each element of the file in turn.
class Reader {
 public:
  Reader(std::string_view kind, AppendedData appended, bool with_triangles)
      : kind_(kind), appended_(appended), with_triangles_(with_triangles) {}

  void begin(std::string_view element, Attributes attributes) {
    if (element == "VTKFile") begin_file(attributes);
    if (element == "Piece") begin_piece(attributes);
    if (element == "DataArray") begin_array(attributes);
    open_.emplace_back(element);
  }
  void text(std::string_view more) {
    if (!open_.empty() && open_.back() == "DataArray") text_ += more;
  }
  void end(std::string_view element) {
    open_.pop_back();
    if (element == "DataArray") end_array();
    if (element == "Piece") end_piece();
  }

  VtkSurface result() {
    if (!is_vtk_) throw InvalidInput("does not begin with an element VTKFile");
    if (!open_.empty() && open_ != std::vector<std::string>{"VTKFile"})
      throw InvalidInput(fmt::format("ends in an element {}", one_line(open_.back(), 30)));
    data_.check_sizes();
    check_cell_arrays();
    return {std::move(data_), std::move(triangles_), std::move(cell_arrays_)};
  }

 private:
  void begin_file(Attributes attributes) {
    const std::string_view type = xml_attribute(attributes, "type"),
                           order = xml_attribute(attributes, "byte_order");
    if (type != kind_)
      throw InvalidInput(fmt::format("holds \"{}\"; expected {}", one_line(type, 30), kind_));
    encoding_.order = order == "BigEndian" ? std::endian::big : std::endian::little;
    encoding_.long_header = xml_attribute(attributes, "header_type") == "UInt64";
    encoding_.compressor = xml_attribute(attributes, "compressor");
    is_vtk_ = true;
  }

  void begin_piece(Attributes attributes) {
    points_ = count_in(attributes, "NumberOfPoints");
    piece_ = {};
  }

  void begin_array(Attributes attributes) {
    const std::string_view owner = open_.empty() ? std::string_view() : std::string_view(open_.back());
    text_.clear();
    owner_ = nullptr;
    if (owner == "PointData") owner_ = &piece_.arrays;
    if (owner == "Points") owner_ = &coordinates_;
    if (owner == "FieldData") owner_ = &data_.fields;
    if (owner == "Polys" && with_triangles_) owner_ = &polygons_;
    if (owner == "CellData" && with_triangles_) owner_ = &piece_cell_arrays_;
    if (const std::string_view type = xml_attribute(attributes, "type"); type == "String" || type == "Bit")
      owner_ = nullptr;  // nothing that particles need
    if (owner_ == nullptr) return;
    type_ = type_in(attributes);
    array_ = {std::string(xml_attribute(attributes, "Name")),
              count_in(attributes, "NumberOfComponents", 1),
              {},
              type_};
    format_ = xml_attribute(attributes, "format");
    offset_ = format_ == "appended" ? count_in(attributes, "offset") : 0;
  }

  void end_array() {
    if (owner_ == nullptr) return;
    if (format_ == "appended") {
      if (offset_ > appended_.bytes.size())
        throw InvalidInput(fmt::format("has no appended data at {}", offset_));
      array_.values = encoded_numbers(appended_.bytes.substr(offset_), appended_.base64, type_, encoding_);
    } else if (format_ == "binary") {
      array_.values = encoded_numbers(text_, true, type_, encoding_);
    } else {
      array_.values = numbers_in(text_);
    }
    owner_->push_back(std::move(array_));
    owner_ = nullptr;
  }

  void end_piece() {
    if (coordinates_.size() != 1 || coordinates_[0].components != 3)
      throw InvalidInput("has no one array of 3 components in Points");
    const std::vector<double>& x = coordinates_[0].values;
    if (x.size() % 3 != 0 || x.size() / 3 != points_)
      throw InvalidInput(fmt::format("has {} coordinates for {} points", x.size(), points_));
    for (std::size_t i = 0; i < x.size(); i += 3) piece_.position.emplace_back(x[i], x[i + 1], x[i + 2]);
    coordinates_.clear();
    piece_.check_sizes();
    if (with_triangles_) append_triangles();
    append_piece();
  }

  void append_triangles() {
    const PointArray *corners = find_array(polygons_, {"connectivity"}, 1),
                     *ends = find_array(polygons_, {"offsets"}, 1);
    if (corners == nullptr || ends == nullptr)
      throw InvalidInput("has no arrays connectivity and offsets in Polys");
    for (std::size_t t = 0; t < ends->values.size(); ++t)
      if (ends->values[t] != 3.0 * static_cast<double>(t + 1))
        throw InvalidInput(fmt::format("polygon {} is no triangle", t));
    if (corners->values.size() != 3 * ends->values.size())
      throw InvalidInput(
          fmt::format("has {} corners for {} triangles", corners->values.size(), ends->values.size()));
    const std::size_t first = data_.position.size();
    for (std::size_t c = 0; c < corners->values.size(); c += 3)
      triangles_.push_back({corner(corners->values[c], first), corner(corners->values[c + 1], first),
                            corner(corners->values[c + 2], first)});
    polygons_.clear();
  }

  /// first: number of the piece's first point.
  int corner(double number, std::size_t first) const {
    if (!(number >= 0 && number < static_cast<double>(points_)) || number != std::floor(number))
      throw InvalidInput(fmt::format("has a triangle with the corner {} of {} points", number, points_));
    return static_cast<int>(first) + static_cast<int>(number);
  }

  void check_cell_arrays() const {
    for (const PointArray& array : cell_arrays_)
      if (array.values.size() != array.components * triangles_.size())
        throw InvalidInput(fmt::format("array \"{}\" has {} numbers for {} triangles",
                                       one_line(array.name, 30), array.values.size(), triangles_.size()));
  }

  void append_piece() {
    data_.position.insert(data_.position.end(), piece_.position.begin(), piece_.position.end());
    append_arrays(piece_.arrays, data_.arrays);
    append_arrays(piece_cell_arrays_, cell_arrays_);
    piece_cell_arrays_.clear();
  }

  /// An array that some of the pieces lack comes out too short.
  static void append_arrays(std::vector<PointArray>& of_piece, std::vector<PointArray>& all) {
    for (PointArray& array : of_piece) {
      const auto same = std::ranges::find_if(
          all, [&](const PointArray& a) { return a.name == array.name && a.components == array.components; });
      if (same == all.end())
        all.push_back(std::move(array));
      else
        same->values.insert(same->values.end(), array.values.begin(), array.values.end());
    }
  }

  std::string_view kind_;
  AppendedData appended_;
  bool with_triangles_, is_vtk_ = false;
  DataEncoding encoding_;
  std::vector<std::string> open_;  // the elements that have begun and not ended
  PointData data_, piece_;
  std::size_t points_ = 0;                                              // of the piece
  std::vector<PointArray> coordinates_, polygons_, piece_cell_arrays_;  // likewise
  std::vector<Triangle> triangles_;
  std::vector<PointArray> cell_arrays_;
  std::vector<PointArray>* owner_ = nullptr;  // where the array goes that is being read
  PointArray array_;
  NumberType type_ = NumberType::float64;
  std::string format_, text_;
  std::size_t offset_ = 0;
};

std::string place_of(XML_Parser parser) {
  return fmt::format("line {}, column {}", xml_line(parser), xml_column(parser));
}

/// Feeds a reader with what expat finds. Exceptions must not cross expat, which is C.
class Parser {
 public:
  explicit Parser(Reader& reader) : reader_(reader), parser_(XML_ParserCreate(nullptr)) {
    if (parser_ == nullptr) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* self, const XML_Char* name, Attributes attributes) {
          static_cast<Parser*>(self)->guarded([&](Reader& r) { r.begin(name, attributes); });
        },
        [](void* self, const XML_Char* name) {
          static_cast<Parser*>(self)->guarded([&](Reader& r) { r.end(name); });
        });
    XML_SetCharacterDataHandler(parser_.get(), [](void* self, const XML_Char* text, int length) {
      static_cast<Parser*>(self)->guarded([&](Reader& r) {
        r.text({text, static_cast<std::size_t>(length)});
      });
    });
  }

  void parse(std::string_view xml, bool whole) {
    constexpr std::size_t kChunk = 1 << 20;  // expat counts in int
    for (std::size_t at = 0; at == 0 || at < xml.size(); at += kChunk) {
      const std::string_view chunk = xml.substr(at, kChunk);
      const bool last = whole && at + kChunk >= xml.size();
      const XML_Status status =
          XML_Parse(parser_.get(), chunk.data(), static_cast<int>(chunk.size()), last ? XML_TRUE : XML_FALSE);
      if (thrown_) std::rethrow_exception(thrown_);
      if (status == XML_STATUS_ERROR)
        throw InvalidInput(fmt::format("is no XML from {} on: {}", place_of(parser_.get()),
                                       XML_ErrorString(XML_GetErrorCode(parser_.get()))));
    }
  }

 private:
  template <class Action>
  void guarded(const Action& action) {
    if (thrown_) return;
    try {
      action(reader_);
    } catch (...) {
      thrown_ = std::current_exception();
      XML_StopParser(parser_.get(), XML_FALSE);
    }
  }

  struct Free {
    void operator()(XML_ParserStruct* parser) const { XML_ParserFree(parser); }
  };
  Reader& reader_;
  std::unique_ptr<XML_ParserStruct, Free> parser_;
  std::exception_ptr thrown_;
};

VtkSurface parse(std::string_view bytes, std::string_view kind, bool with_triangles) {
  const std::size_t head = std::min(bytes.find("<AppendedData"), bytes.size());
  const std::string_view tail = bytes.substr(head);
  AppendedData appended;
  if (const std::size_t start = tail.find('>'); start < tail.size()) {
    appended.base64 = tail.substr(0, start).find("base64") != std::string_view::npos;
    const std::size_t mark = tail.find('_', start);  // the data begin after it
    if (mark != std::string_view::npos) appended.bytes = tail.substr(mark + 1);
  }
  Reader reader(kind, appended, with_triangles);
  Parser(reader).parse(bytes.substr(0, head), tail.empty());
  return reader.result();
}

}  // namespace

PointData parse_vtk_xml(std::string_view bytes, std::string_view kind) {
  return parse(bytes, kind, false).points;
}

VtkSurface parse_vtk_surface(std::string_view bytes) {
  return parse(bytes, "PolyData", true);
}

}  // namespace kappaflow
