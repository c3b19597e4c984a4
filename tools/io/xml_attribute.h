// Attributes of an XML element, as expat hands them over.
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

}  // namespace kappaflow
