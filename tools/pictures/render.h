// `kappaflow render`: pictures and films of the surfaces of a run.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenes/view.h"
#include "tools/pictures/colouring.h"

namespace kappaflow {

/// What fills a panel.
enum class Fit {
  liquid,  ///< the surfaces; a film's camera follows them
  scene,   ///< walls and surfaces; the camera stands still
};

struct RenderOptions {
  std::filesystem::path folder;        ///< of a run
  std::filesystem::path out;           ///< .png: a picture; .mp4: a film; empty: film.mp4 in the run folder
  std::optional<int> frame;            ///< of a picture; default: the last one that every method has
  std::vector<std::string> methods;    ///< empty: all of the run
  int columns = 0;                     ///< panels a row; 0: all in one row
  std::string colour = kCheckerArray;  ///< point array
  std::optional<ValueRange> range;     ///< of its values; default: value_range() of all that is drawn
  Fit fit = Fit::liquid;
  std::optional<std::array<int, 2>> size;   ///< of a panel: width and height [pixels]
  std::optional<Vec3> view_from, view_up;   ///< instead of the run's, see View
  std::optional<double> frames_per_second;  ///< of a film; default: one second a simulated second
};

/// Draws one panel a method, all with the same camera, whatever colours the surfaces. The pictures
/// of a film stay in pictures_folder(). Returns the program's exit code. Throws InvalidInput (no such frame,
/// method or array), IoError (not a run folder, no display, file not writable, no ffmpeg).
int render(const RenderOptions& options);

}  // namespace kappaflow
