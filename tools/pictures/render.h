// `kappaflow render`: pictures and films of the surfaces of a run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenes/view.h"
#include "tools/pictures/colouring.h"

namespace kappaflow {

struct RenderOptions {
  std::filesystem::path folder;        ///< of a run
  std::filesystem::path out;           ///< .png: a picture; .mp4: a film; empty: film.mp4 in the run folder
  std::optional<int> frame;            ///< of a picture; default: the last one that every method has
  std::vector<std::string> methods;    ///< empty: all of the run
  int columns = 0;                     ///< panels a row; 0: all in one row
  std::string colour = kCheckerArray;  ///< point array
  std::optional<ValueRange> range;     ///< of its values; default: value_range() of all that is drawn
  std::optional<Vec3> view_from, view_up;   ///< instead of the run's, see View
  std::optional<double> frames_per_second;  ///< of a film; default: one second a simulated second
};

/// Draws one panel a method, each from the same view, which is the same for all frames of a run. The pictures
/// of a film stay in pictures_folder(). Returns the program's exit code. Throws InvalidInput (no such frame,
/// method or array), IoError (not a run folder, no display, file not writable, no ffmpeg).
int render(const RenderOptions& options);

}  // namespace kappaflow
