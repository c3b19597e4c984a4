#include "tools/pictures/render.h"

#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtk_jsoncpp.h>

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
#include "core/quantile.h"
#include "tools/io/files.h"
#include "tools/io/surface_file.h"
#include "tools/pictures/film.h"
#include "tools/pictures/hiding_walls.h"
#include "tools/pictures/picture.h"
#include "tools/runs/progress.h"
#include "tools/runs/run_folder.h"
#include "tools/runs/run_record.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr double kFallbackRate = 25;  // frames a second, where a run has one frame only
constexpr double kFollowed = 0.5;     // how far a film's camera looks ahead and back [s]
constexpr double kSpray = 0.002;      // share of a surface's vertices that may lie outside at each side
constexpr double kMargin = 1.1;       // around the liquid

std::vector<std::string> chosen_methods(const RenderOptions& options, const Json::Value& record) {
  std::vector<std::string> tracked;
  for (const Json::Value& method : record["methods"]) tracked.push_back(method.asString());
  if (options.methods.empty()) return tracked;
  for (const std::string& method : options.methods)
    if (std::ranges::find(tracked, method) == tracked.end())
      throw InvalidInput(
          fmt::format("{} has no surface tracked with \"{}\"", options.folder.string(), method));
  return options.methods;
}

/// The one that the command line asks for, else that of the run's scene, else the default.
View chosen_view(const RenderOptions& options, const Json::Value& record) {
  const auto vector = [](const Json::Value& array) {
    return Vec3(array[0].asDouble(), array[1].asDouble(), array[2].asDouble());
  };
  View view;
  if (record.isMember("view")) view = {vector(record["view"]["from"]), vector(record["view"]["up"])};
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
      : options_(options), record_(read_record(options.folder)), methods_(chosen_methods(options, record_)) {
    while (has_frame(frames_)) ++frames_;
    if (frames_ == 0) throw InvalidInput(fmt::format("{} has no frames yet", options.folder.string()));
    style_ = {.columns = options.columns, .view = chosen_view(options, record_)};
    if (options.size)
      std::tie(style_.panel_width, style_.panel_height) = std::pair((*options.size)[0], (*options.size)[1]);
    if (fs::exists(options.folder / kBoundaryFile))
      walls_at_rest_ = read_surface(options.folder / kBoundaryFile);
  }

  int frames() const { return frames_; }
  /// Fixes what is the same in frames [first, last]: colours, walls that are seen through, and the camera's
  /// way, which sees `reach` frames ahead.
  void prepare(int first, int last, int reach);
  /// Draws a frame of those.
  void draw(const fs::path& file, int frame) const;

  std::vector<double> times() const;  ///< of all frames [s]

 private:
  bool has_frame(int frame) const {
    return std::ranges::all_of(
        methods_, [&](const auto& m) { return fs::exists(options_.folder / surface_file(m, frame)); });
  }
  vtkSmartPointer<vtkPolyData> surface(const std::string& method, int frame) const {
    return read_surface(options_.folder / surface_file(method, frame));
  }
  vtkSmartPointer<vtkPolyData> walls(int frame) const;
  void choose_colours(int first, int last);
  void choose_glass(int first, int last);
  Framing liquid_at(int frame) const;
  Framing whole_scene() const;

  const RenderOptions& options_;
  Json::Value record_;
  std::vector<std::string> methods_;
  int frames_ = 0;
  PictureStyle style_;
  vtkSmartPointer<vtkPolyData> walls_at_rest_;
  std::vector<char> glass_;       // an entry a triangle of the walls
  int first_ = 0;                 // of the frames that are drawn
  std::vector<Framing> framing_;  // of each
};

vtkSmartPointer<vtkPolyData> Drawing::walls(int frame) const {
  const fs::path moving = options_.folder / boundary_file(frame);
  return fs::exists(moving) ? read_surface(moving) : walls_at_rest_;
}

void Drawing::prepare(int first, int last, int reach) {
  choose_colours(first, last);
  choose_glass(first, last);
  first_ = first;
  framing_.clear();
  if (options_.fit == Fit::scene) {
    framing_.assign(static_cast<std::size_t>(last - first + 1), whole_scene());
    return;
  }
  for (int frame = first; frame <= last; ++frame) framing_.push_back(liquid_at(frame));
  framing_ = followed(framing_, reach);
}

/// The surfaces of all methods, but for some spray.
Framing Drawing::liquid_at(int frame) const {
  std::vector<vtkSmartPointer<vtkPolyData>> surfaces;
  for (const std::string& method : methods_) surfaces.push_back(surface(method, frame));
  const std::vector<vtkPolyData*> parts(surfaces.begin(), surfaces.end());
  Framing liquid = framing(parts, style_.view, kSpray);
  liquid.half *= kMargin;
  return liquid;
}

/// Walls and first surface in the first and the last frame of the run.
Framing Drawing::whole_scene() const {
  const std::array parts{walls(0), walls(frames_ - 1), surface(methods_.front(), 0),
                         surface(methods_.front(), frames_ - 1)};
  const std::vector<vtkPolyData*> pointers(parts.begin(), parts.end());
  return framing(pointers, style_.view, 0);
}

/// What hides the first surface in the first, the middle or the last frame: walls do not flicker.
void Drawing::choose_glass(int first, int last) {
  glass_.clear();
  for (const int frame : {first, first + (last - first) / 2, last}) {
    const auto here = walls(frame);
    if (!here) continue;
    const std::vector<char> hides =
        hiding_triangles(*here, *surface(methods_.front(), frame), style_.view.from);
    glass_.resize(hides.size());
    std::ranges::transform(hides, glass_, glass_.begin(), std::bit_or<char>());
  }
}

void Drawing::choose_colours(int first, int last) {
  if (options_.colour == kCheckerArray) return;
  const auto example = surface(methods_.front(), first);
  ValueRange range = options_.range ? *options_.range : value_range(*example, options_.colour);
  if (!options_.range)
    for (int frame = first; frame <= last; ++frame)
      for (const std::string& method : methods_) {
        const ValueRange here = value_range(*surface(method, frame), options_.colour);
        range = {std::min(range[0], here[0]), std::max(range[1], here[1])};
      }
  if (!options_.range) range = rounded(range);
  style_.colouring = colouring(*example, options_.colour, range);
}

double time_of(vtkPolyData& surface) {
  vtkDataArray* const time = surface.GetFieldData()->GetArray("TimeValue");
  const double value = time != nullptr && time->GetNumberOfValues() > 0 ? time->GetComponent(0, 0) : 0;
  return std::isfinite(value) ? value : 0;
}

std::vector<double> Drawing::times() const {
  std::vector<double> times;
  for (int frame = 0; frame < frames_; ++frame) times.push_back(time_of(*surface(methods_.front(), frame)));
  return times;
}

void Drawing::draw(const fs::path& file, int frame) const {
  std::vector<Panel> panels;
  for (const std::string& method : methods_) {
    const auto drawn = surface(method, frame);
    panels.push_back({fmt::format("{},  t = {:.2f} s", method, time_of(*drawn)), drawn});
  }
  Walls around;
  if (const auto here = walls(frame)) around = {part_of(*here, glass_, 0), part_of(*here, glass_, 1)};
  draw_picture(file, panels, around, framing_[static_cast<std::size_t>(frame - first_)], style_);
}

int draw_one(const RenderOptions& options, Drawing& drawing) {
  if (options.frames_per_second) throw InvalidInput("--fps is of films, whose names end in .mp4");
  const int frame = options.frame.value_or(drawing.frames() - 1);
  if (frame >= drawing.frames())
    throw InvalidInput(
        fmt::format("{} has frames 0 to {}, not {}", options.folder.string(), drawing.frames() - 1, frame));
  drawing.prepare(frame, frame, 0);
  drawing.draw(options.out, frame);
  return 0;
}

/// Simulated time passes as fast as that of the film, but for frames that are not equally far apart.
double real_time_rate(const std::vector<double>& times) {
  std::vector<double> intervals;
  for (std::size_t k = 1; k < times.size(); ++k) intervals.push_back(times[k] - times[k - 1]);
  const double interval = intervals.empty() ? 0 : quantile(intervals, 0.5);
  return interval > 0 ? 1 / interval : kFallbackRate;
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
  const double rate = options.frames_per_second.value_or(real_time_rate(drawing.times()));
  drawing.prepare(0, drawing.frames() - 1, static_cast<int>(kFollowed * rate));
  for (int frame = 0; frame < drawing.frames(); ++frame) {
    draw_status_line(fmt::format("frame {}/{}", frame, drawing.frames() - 1));
    drawing.draw(film_picture(pictures, frame), frame);
  }
  draw_status_line("");
  remove_pictures_from(pictures, drawing.frames());
  make_film(film, pictures, drawing.frames(), rate);
  fmt::print("{}: {} frames, {:.4g} a second; each of them as a picture in {}\n", film.string(),
             drawing.frames(), rate, pictures.string());
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
