// What expat, which parses XML, says of an element: its attributes, and where in the file it is.
#pragma once

#include <expat.h>

#include <string_view>

namespace kappaflow {

/// The value of an attribute; empty where the element does not have it.
inline std::string_view xml_attribute(const XML_Char** attributes, std::string_view name) {
  for (; *attributes != nullptr; attributes += 2)
    if (attributes[0] == name) return attributes[1];
  return {};
}

// Deprecated since expat 2.8 in favour of functions that older ones do not have.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
/// From 1.
inline XML_Size xml_line(XML_Parser parser) {
  return XML_GetCurrentLineNumber(parser);
}
/// From 1.
inline XML_Size xml_column(XML_Parser parser) {
  return XML_GetCurrentColumnNumber(parser) + 1;
}
#pragma GCC diagnostic pop

}  // namespace kappaflow
