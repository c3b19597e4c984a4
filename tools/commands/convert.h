// `kappaflow convert`: a run in the files of other programs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/types.h"
#include "tools/io/mesh_formats.h"

namespace kappaflow {

struct ConvertOptions {
  std::filesystem::path folder;      ///< of a run
  std::filesystem::path out;         ///< empty: the run folder
  std::vector<MeshFormat> formats;   ///< empty: usd
  std::vector<std::string> methods;  ///< empty: all of the run
  std::optional<Vec3> up;            ///< what points up; empty: as pictures have it
};

/// Writes the files that the run would have written by --format: the same bytes, frame after frame, and
/// complete at any moment as far as it is. Says on stdout what there is to open. SIGINT and SIGTERM end it
/// after the current frame. Returns the exit code: 0, or 130 or 143 after a signal. Throws InvalidInput (no
/// such method, no frames, a run that is writing into the folder), IoError (not a run folder, a damaged file,
/// not writable).
int convert(const ConvertOptions& options);

}  // namespace kappaflow
