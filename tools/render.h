// `kappaflow render`: a picture of the surfaces of a run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kappaflow {

struct RenderOptions {
  std::filesystem::path folder;      ///< of a run
  std::filesystem::path picture;     ///< .png
  int frame = -1;                    ///< -1: the last one that every chosen method has
  std::vector<std::string> methods;  ///< empty: all of the run
  int columns = 0;                   ///< panels a row; 0: all in one row
};

/// Draws one panel a method, each from the same view, which is the same for all frames of a run.
/// Throws InvalidInput (no such frame or method), IoError (not a run folder, no display, picture not
/// writable).
void render(const RenderOptions& options);

}  // namespace kappaflow
