#include "tools/io/pvd.h"

#include <fmt/format.h>

#include <iterator>

namespace kappaflow {

// Names and files are the program's own (method names, fixed folders): nothing in them needs escaping.
std::string pvd_text(std::span<const PvdEntry> entries) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (const PvdEntry& entry : entries)
    fmt::format_to(std::back_inserter(text),
                   "    <DataSet timestep=\"{}\" group=\"\" part=\"{}\" name=\"{}\" file=\"{}\"/>\n",
                   entry.time, entry.part, entry.name, entry.file);
  return text + "  </Collection>\n</VTKFile>\n";
}

}  // namespace kappaflow
