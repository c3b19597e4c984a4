// What all readers of VTK XML files have in common: elements, and the arrays in them.
#pragma once

#include <expat.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tools/io/point_data.h"
#include "tools/io/vtk_xml_binary.h"

namespace kappaflow {

/// Goes through a file, and decodes the arrays that whoever derives from it wants. Arrays may be text, inline
/// binary or appended (base64 or raw), of either byte order, and compressed in the ways that VTK knows.
/// Trusts nothing in the file, and throws InvalidInput that says what is wrong. Written here because VTK
/// 9.1's readers crash on damaged files, and ask for as much memory as they claim to need.
class VtkXmlReader {
 public:
  using Attributes = const XML_Char**;

  virtual ~VtkXmlReader() = default;
  void read(std::string_view bytes);

 protected:
  /// kind: of data set, as the file must name it.
  explicit VtkXmlReader(std::string_view kind) : kind_(kind) {}

  /// An element that is no array begins or ends.
  virtual void begin_part(std::string_view element, Attributes attributes) = 0;
  virtual void end_part(std::string_view element) = 0;
  /// Where the arrays in such an element go; null where they are not wanted.
  virtual std::vector<PointArray>* arrays_in(std::string_view element) = 0;

 private:
  friend class XmlEvents;

  void begin(std::string_view element, Attributes attributes);
  void text(std::string_view more);
  void end(std::string_view element);
  void begin_file(Attributes attributes);
  void begin_array(Attributes attributes);
  void take_numbers(std::size_t length);
  void end_array();

  std::string_view kind_;
  std::string_view appended_;  // the part after the XML, which need not be well-formed
  bool appended_base64_ = false, is_vtk_ = false;
  DataEncoding encoding_;
  std::vector<std::string> open_;             // the elements that have begun and not ended
  std::vector<PointArray>* owner_ = nullptr;  // where the array goes that is being read
  PointArray array_;
  NumberType type_ = NumberType::float64;
  bool is_text_ = false;
  std::string format_, text_;  // the latter as far as its numbers are not read
  std::size_t offset_ = 0;
};

/// A whole number among the attributes. Throws InvalidInput where there is none.
std::size_t count_in(VtkXmlReader::Attributes attributes, std::string_view name);

/// Of a piece in a parallel file. Throws InvalidInput where there is none.
std::string piece_source(VtkXmlReader::Attributes attributes);

/// The numbers in a text with blanks between them. Throws InvalidInput.
std::vector<double> numbers_in(std::string_view text);

}  // namespace kappaflow
