#include "tools/pictures/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>

#include "core/errors.h"
#include "tools/io/files.h"
#include "tools/pictures/film.h"
#include "tools/pictures/hiding_walls.h"
#include "tools/pictures/picture.h"
#include "tools/pictures/run_frames.h"
#include "tools/runs/progress.h"
#include "tools/runs/run_folder.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

/// The one that the command line asks for, else that of the run.
View chosen_view(const RenderOptions& options, View view) {
  if (options.view_up) view = view_with(*options.view_up);
  if (options.view_from) view.from = *options.view_from;
  if (!is_view(view))
    throw InvalidInput(
        "the direction to the viewer and the one that is up must be neither zero nor parallel");
  return view;
}

/// A run's frames as they are drawn.
class Drawing {
 public:
  explicit Drawing(const RenderOptions& options)
      : options_(options), frames_(options.folder, options.methods) {
    style_ = {.columns = options.columns, .view = chosen_view(options, frames_.view())};
    if (options.size)
      std::tie(style_.panel_width, style_.panel_height) = std::pair((*options.size)[0], (*options.size)[1]);
  }

  const RunFrames& frames() const { return frames_; }
  /// Fixes what is the same in frames [first, last]: colours, walls that are seen through, and the camera's
  /// way, which sees `reach` frames ahead.
  void prepare(int first, int last, int reach);
  /// Draws a frame of those.
  void draw(const fs::path& file, int frame) const;

 private:
  void choose_colours(int first, int last);
  void choose_glass(int first, int last);
  Framing liquid_at(int frame) const;
  Framing whole_scene() const;

  const RenderOptions& options_;
  RunFrames frames_;
  PictureStyle style_;
  std::vector<char> glass_;       // an entry a triangle of the walls
  int first_ = 0;                 // of the frames that are drawn
  std::vector<Framing> framing_;  // of each
};

void Drawing::prepare(int first, int last, int reach) {
  choose_colours(first, last);
  choose_glass(first, last);
  first_ = first;
  framing_.clear();
  if (options_.fit == Fit::scene) {
    const int frames = last - first + 1;
    framing_.assign(static_cast<std::size_t>(frames), whole_scene());
    return;
  }
  for (int frame = first; frame <= last; ++frame) framing_.push_back(liquid_at(frame));
  framing_ = followed(framing_, reach);
}

/// The surfaces of all methods, but for some spray.
Framing Drawing::liquid_at(int frame) const {
  std::vector<vtkSmartPointer<vtkPolyData>> surfaces;
  for (const std::string& method : frames_.methods()) surfaces.push_back(frames_.surface(method, frame));
  const std::vector<vtkPolyData*> parts(surfaces.begin(), surfaces.end());
  return liquid_framing(parts, style_.view);
}

/// Walls and first surface in the first and the last frame of the run.
Framing Drawing::whole_scene() const {
  const std::string& method = frames_.methods().front();
  const int last = frames_.count() - 1;
  const std::array parts{frames_.walls(0), frames_.walls(last), frames_.surface(method, 0),
                         frames_.surface(method, last)};
  const std::vector<vtkPolyData*> pointers(parts.begin(), parts.end());
  return framing(pointers, style_.view, 0);
}

/// What hides the first surface in the first, the middle or the last frame: walls do not flicker.
void Drawing::choose_glass(int first, int last) {
  glass_.clear();
  for (const int frame : {first, first + (last - first) / 2, last}) {
    const auto here = frames_.walls(frame);
    if (!here) continue;
    const std::vector<char> hides =
        hiding_triangles(*here, *frames_.surface(frames_.methods().front(), frame), style_.view.from);
    glass_.resize(hides.size());
    std::ranges::transform(hides, glass_, glass_.begin(), std::bit_or<char>());
  }
}

void Drawing::choose_colours(int first, int last) {
  if (options_.colour == kCheckerArray) return;
  const auto example = frames_.surface(frames_.methods().front(), first);
  ValueRange range = options_.range ? *options_.range : value_range(*example, options_.colour);
  if (!options_.range)
    for (int frame = first; frame <= last; ++frame)
      for (const std::string& method : frames_.methods()) {
        const ValueRange here = value_range(*frames_.surface(method, frame), options_.colour);
        range = {std::min(range[0], here[0]), std::max(range[1], here[1])};
      }
  if (!options_.range && !holds_names(*example, options_.colour)) range = rounded(range);
  style_.colouring = colouring(*example, options_.colour, range);
}

void Drawing::draw(const fs::path& file, int frame) const {
  std::vector<Panel> panels;
  for (const std::string& method : frames_.methods()) {
    const auto drawn = frames_.surface(method, frame);
    panels.push_back({fmt::format("{},  t = {:.2f} s", method, time_of(*drawn)), drawn});
  }
  Walls around;
  if (const auto here = frames_.walls(frame)) around = {part_of(*here, glass_, 0), part_of(*here, glass_, 1)};
  draw_picture(file, panels, around, framing_[static_cast<std::size_t>(frame - first_)], style_);
}

int draw_one(const RenderOptions& options, Drawing& drawing) {
  if (options.frames_per_second) throw InvalidInput("--fps is of films, whose names end in .mp4");
  const int frame = options.frame.value_or(drawing.frames().count() - 1);
  if (frame >= drawing.frames().count())
    throw InvalidInput(fmt::format("{} has frames 0 to {}, not {}", options.folder.string(),
                                   drawing.frames().count() - 1, frame));
  drawing.prepare(frame, frame, 0);
  drawing.draw(options.out, frame);
  return 0;
}

/// Of a longer film that was here before.
void remove_pictures_from(const fs::path& folder, int frame) {
  std::error_code error;
  while (fs::remove(film_picture(folder, frame), error)) ++frame;
  if (error) throw IoError(film_picture(folder, frame).string(), error.message());
}

int draw_all(const RenderOptions& options, const fs::path& film, Drawing& drawing) {
  if (options.frame) throw InvalidInput("--frame is of pictures, whose names end in .png");
  const fs::path pictures = pictures_folder(film);
  make_folder(pictures);
  const double rate = options.frames_per_second.value_or(real_time_rate(drawing.frames().times()));
  drawing.prepare(0, drawing.frames().count() - 1, camera_reach(rate));
  for (int frame = 0; frame < drawing.frames().count(); ++frame) {
    draw_status_line(fmt::format("frame {}/{}", frame, drawing.frames().count() - 1));
    drawing.draw(film_picture(pictures, frame), frame);
  }
  draw_status_line("");
  remove_pictures_from(pictures, drawing.frames().count());
  make_film(film, pictures, drawing.frames().count(), rate);
  fmt::print("{}: {} frames, {:.4g} a second; each of them as a picture in {}\n", film.string(),
             drawing.frames().count(), rate, pictures.string());
  return 0;
}

}  // namespace

int render(const RenderOptions& options) {
  const fs::path out = options.out.empty() ? options.folder / "film.mp4" : options.out;
  const bool film = out.extension() == ".mp4";
  if (!film && out.extension() != ".png")
    throw InvalidInput(
        fmt::format("found \"{}\"; expected a file name that ends in .png or .mp4", out.string()));
  Drawing drawing(options);
  return film ? draw_all(options, out, drawing) : draw_one(options, drawing);
}

}  // namespace kappaflow
