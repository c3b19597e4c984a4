// "VTK XML File Formats": https://docs.vtk.org/en/latest/design_documents/
#include "tools/io/vtk_xml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include "core/errors.h"
#include "core/named.h"
#include "core/parse_number.h"
#include "core/text_scanner.h"
#include "tools/io/xml_parser.h"

namespace kappaflow {
namespace {

using Attributes = VtkXmlReader::Attributes;

constexpr std::string_view kXmlBlanks = " \t\r\n";

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

std::string place_of(XML_Parser parser) {
  return fmt::format("line {}, column {}", xml_line(parser), xml_column(parser));
}

}  // namespace

/// Feeds a reader with what expat finds. Exceptions must not cross expat, which is C.
class XmlEvents {
 public:
  explicit XmlEvents(VtkXmlReader& reader) : reader_(reader), parser_(XML_ParserCreate(nullptr)) {
    if (parser_ == nullptr) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* self, const XML_Char* name, Attributes attributes) {
          static_cast<XmlEvents*>(self)->guarded([&](VtkXmlReader& r) { r.begin(name, attributes); });
        },
        [](void* self, const XML_Char* name) {
          static_cast<XmlEvents*>(self)->guarded([&](VtkXmlReader& r) { r.end(name); });
        });
    XML_SetCharacterDataHandler(parser_.get(), [](void* self, const XML_Char* text, int length) {
      static_cast<XmlEvents*>(self)->guarded([&](VtkXmlReader& r) {
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
  VtkXmlReader& reader_;
  std::unique_ptr<XML_ParserStruct, Free> parser_;
  std::exception_ptr thrown_;
};

void VtkXmlReader::read(std::string_view bytes) {
  const std::size_t head = std::min(bytes.find("<AppendedData"), bytes.size());
  const std::string_view tail = bytes.substr(head);
  if (const std::size_t start = tail.find('>'); start < tail.size()) {
    appended_base64_ = tail.substr(0, start).find("base64") != std::string_view::npos;
    const std::size_t mark = tail.find('_', start);  // the data begin after it
    if (mark != std::string_view::npos) appended_ = tail.substr(mark + 1);
  }
  XmlEvents(*this).parse(bytes.substr(0, head), tail.empty());
  if (!is_vtk_) throw InvalidInput("does not begin with an element VTKFile");
  if (!open_.empty() && open_ != std::vector<std::string>{"VTKFile"})
    throw InvalidInput(fmt::format("ends in an element {}", one_line(open_.back(), 30)));
}

void VtkXmlReader::begin(std::string_view element, Attributes attributes) {
  if (element == "VTKFile")
    begin_file(attributes);
  else if (element == "DataArray")
    begin_array(attributes);
  else
    begin_part(element, attributes);
  open_.emplace_back(element);
}

void VtkXmlReader::text(std::string_view more) {
  constexpr std::size_t kEnough = 1 << 10;
  if (open_.empty() || open_.back() != "DataArray" || owner_ == nullptr) return;
  text_ += more;
  if (is_text_ && text_.size() > kEnough) take_numbers(text_.find_last_of(kXmlBlanks) + 1);
}

/// Those in the first characters of the text so far: of a long array it need not be there as a whole.
void VtkXmlReader::take_numbers(std::size_t length) {
  const std::vector<double> numbers = numbers_in(std::string_view(text_).substr(0, length));
  array_.values.insert(array_.values.end(), numbers.begin(), numbers.end());
  text_.erase(0, length);
}

void VtkXmlReader::end(std::string_view element) {
  open_.pop_back();
  if (element == "DataArray")
    end_array();
  else
    end_part(element);
}

void VtkXmlReader::begin_file(Attributes attributes) {
  const std::string_view type = xml_attribute(attributes, "type"),
                         order = xml_attribute(attributes, "byte_order");
  if (type != kind_) throw InvalidInput(fmt::format("holds \"{}\"; expected {}", one_line(type, 30), kind_));
  encoding_.order = order == "BigEndian" ? std::endian::big : std::endian::little;
  encoding_.long_header = xml_attribute(attributes, "header_type") == "UInt64";
  encoding_.compressor = xml_attribute(attributes, "compressor");
  is_vtk_ = true;
}

void VtkXmlReader::begin_array(Attributes attributes) {
  text_.clear();
  owner_ = open_.empty() ? nullptr : arrays_in(open_.back());
  if (const std::string_view type = xml_attribute(attributes, "type"); type == "String" || type == "Bit")
    owner_ = nullptr;  // nothing that is needed
  if (owner_ == nullptr) return;
  type_ = type_in(attributes);
  const bool one = xml_attribute(attributes, "NumberOfComponents").empty();
  array_ = {std::string(xml_attribute(attributes, "Name")),
            one ? 1 : count_in(attributes, "NumberOfComponents"),
            {},
            type_};
  format_ = xml_attribute(attributes, "format");
  is_text_ = format_ != "appended" && format_ != "binary";
  offset_ = format_ == "appended" ? count_in(attributes, "offset") : 0;
}

void VtkXmlReader::end_array() {
  if (owner_ == nullptr) return;
  if (format_ == "appended") {
    if (offset_ > appended_.size()) throw InvalidInput(fmt::format("has no appended data at {}", offset_));
    array_.values = encoded_numbers(appended_.substr(offset_), appended_base64_, type_, encoding_);
  } else if (format_ == "binary") {
    array_.values = encoded_numbers(text_, true, type_, encoding_);
    std::string().swap(text_);
  } else {
    take_numbers(text_.size());
  }
  owner_->push_back(std::move(array_));
  owner_ = nullptr;
}

std::size_t count_in(Attributes attributes, std::string_view name) {
  const std::string_view text = xml_attribute(attributes, name);
  if (const auto count = parse_number<std::size_t>(text)) return *count;
  throw InvalidInput(fmt::format("{} is \"{}\"; expected a whole number >= 0", name, one_line(text, 30)));
}

std::string piece_source(Attributes attributes) {
  const std::string_view source = xml_attribute(attributes, "Source");
  if (source.empty()) throw InvalidInput("has a piece without a Source");
  return std::string(source);
}

std::vector<double> numbers_in(std::string_view text) {
  std::vector<double> values;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(kXmlBlanks), text.size()));
    if (text.empty()) return values;
    const std::string_view word = text.substr(0, text.find_first_of(kXmlBlanks));
    values.push_back(number_from(word));
    text.remove_prefix(word.size());
  }
}

}  // namespace kappaflow
