// ParaView data files (.pvd): which data file belongs to which time.
#pragma once

#include <span>
#include <string>

namespace kappaflow {

/// One data file of a collection.
struct PvdEntry {
  double time = 0;   ///< [s]
  int part = 0;      ///< files of one time are told apart by their part
  std::string name;  ///< of the part
  std::string file;  ///< relative to the .pvd
};

/// The text of a .pvd file.
std::string pvd_text(std::span<const PvdEntry> entries);

}  // namespace kappaflow
