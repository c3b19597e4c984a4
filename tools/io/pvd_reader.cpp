#include "tools/io/pvd_reader.h"

#include <fmt/format.h>

#include <memory>
#include <string_view>

#include "core/errors.h"
#include "core/parse_number.h"
#include "core/read_file.h"
#include "tools/io/point_data.h"
#include "tools/io/xml_parser.h"

namespace kappaflow {
namespace {

/// What the elements of a .pvd said so far.
struct Collection {
  bool found = false;  // whether it is a .pvd at all
  std::vector<PvdEntry> entries;
  std::vector<std::string> times;  // as they are written, one an entry
};

void begin_element(void* data, const XML_Char* element, const XML_Char** attributes) {
  auto& collection = *static_cast<Collection*>(data);
  if (element == std::string_view("VTKFile"))
    collection.found = xml_attribute(attributes, "type") == "Collection";
  if (element != std::string_view("DataSet")) return;
  PvdEntry& entry = collection.entries.emplace_back();
  entry.part = parse_number<int>(xml_attribute(attributes, "part")).value_or(0);
  entry.name = xml_attribute(attributes, "name");
  entry.file = xml_attribute(attributes, "file");
  collection.times.emplace_back(xml_attribute(attributes, "timestep"));
}

}  // namespace

std::vector<PvdEntry> read_pvd(const std::filesystem::path& file) {
  const std::string text = read_file(file);
  const std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser(XML_ParserCreate(nullptr),
                                                                            &XML_ParserFree);
  Collection collection;
  XML_SetUserData(parser.get(), &collection);
  XML_SetStartElementHandler(parser.get(), begin_element);
  const XML_Status status = XML_Parse(parser.get(), text.data(), static_cast<int>(text.size()), XML_TRUE);
  if (status == XML_STATUS_ERROR)
    throw IoError(file.string(), fmt::format("line {}: {}", xml_line(parser.get()),
                                             XML_ErrorString(XML_GetErrorCode(parser.get()))));
  if (!collection.found) throw IoError(file.string(), "is not a ParaView collection (.pvd)");
  for (std::size_t k = 0; k < collection.entries.size(); ++k) try {
      collection.entries[k].time = number_from(collection.times[k]);
    } catch (const InvalidInput& error) {
      throw InvalidInput({file.string()},
                         fmt::format("the time of {}: {}", collection.entries[k].file, error.what()));
    }
  return collection.entries;
}

}  // namespace kappaflow
