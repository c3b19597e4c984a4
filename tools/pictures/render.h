// `kappaflow render`: pictures and films of the surfaces of a run.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scenes/view.h"
#include "tools/pictures/colouring.h"
#include "tools/pictures/run_frames.h"

namespace kappaflow {

/// What fills a panel.
enum class Fit {
  liquid,  ///< the surfaces; a film's camera follows them
  scene,   ///< walls and surfaces; the camera stands still
};

/// From the first to the last, both counted in.
struct FrameSpan {
  int first, last;
};

struct RenderOptions {
  std::filesystem::path folder;  ///< of a run
  std::filesystem::path out;  ///< .png: a picture; a film's, see is_film(); empty: film.mp4 in the run folder
  std::optional<int> frame;   ///< of a picture; default: the last one that every method has
  std::optional<FrameSpan> frames;   ///< of a film; default: all that every method has
  std::vector<std::string> methods;  ///< empty: all of the run
  int columns = 0;                   ///< panels a row; 0: all in one row
  std::string
      colour;  ///< a texture, see is_texture(), a point array, or emission_time; empty: default_colour()
  std::optional<ValueRange> range;  ///< of the array's values; default: value_range() of all that is drawn
  Fit fit = Fit::liquid;
  std::optional<std::array<int, 2>> size;   ///< of a panel: width and height [pixels]
  std::optional<Vec3> view_from, view_up;   ///< instead of the run's, see View
  std::optional<double> frames_per_second;  ///< of a film; default: one second a simulated second
};

/// What tells most of a run: where the liquid comes from, where some of it flows in and it comes from several
/// blocks or emitters; when it came, where all of it is one emitter's; else the checker. Throws IoError.
std::string default_colour(const RunFrames& frames);

/// Draws one panel a method, all with the same camera, whatever colours the surfaces. The pictures
/// of a film stay in pictures_folder(). Returns the program's exit code. Throws InvalidInput (no such frame,
/// method or array), IoError (not a run folder, no display, file not readable or writable, no ffmpeg).
int render(const RenderOptions& options);

}  // namespace kappaflow
