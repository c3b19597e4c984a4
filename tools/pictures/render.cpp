#include "tools/pictures/render.h"

#include <fmt/format.h>
#include <vtkPointData.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "core/errors.h"
#include "tools/io/files.h"
#include "tools/pictures/emission.h"
#include "tools/pictures/film.h"
#include "tools/pictures/hiding_walls.h"
#include "tools/pictures/picture.h"
#include "tools/pictures/surface_arrays.h"
#include "tools/runs/frame_rate.h"
#include "tools/runs/progress.h"

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

ValueRange wider(const std::optional<ValueRange>& range, const ValueRange& other) {
  if (!range) return other;
  return {std::min((*range)[0], other[0]), std::max((*range)[1], other[1])};
}

/// Around the first mesh.
Bounds rest_box(const RunFrames& frames) {
  const auto surface = frames.surface(frames.methods().front(), 0);
  vtkDataArray& rest = array_in(*surface->GetPointData(), "rest_position", 3, surface->GetNumberOfPoints());
  std::vector<Vec3> places;
  for (vtkIdType v = 0; v < rest.GetNumberOfTuples(); ++v) places.emplace_back(rest.GetTuple3(v));
  return bounding_box(places);
}

/// A run's frames as they are drawn.
class Drawing {
 public:
  explicit Drawing(const RenderOptions& options)
      : options_(options),
        frames_(options.folder, options.methods),
        colour_(options.colour.empty() ? default_colour(frames_) : options.colour) {
    style_ = {.columns = options.columns, .view = chosen_view(options, frames_.view())};
    if (options.size)
      std::tie(style_.panel_width, style_.panel_height) = std::pair((*options.size)[0], (*options.size)[1]);
    if (is_texture(colour_)) style_.texture = solid_texture(colour_, rest_box(frames_), frames_.projection());
  }

  const RunFrames& frames() const { return frames_; }
  /// Fixes what is the same in frames [first, last]: colours, walls that are seen through, the camera's way.
  void prepare(int first, int last);
  double rate() const { return rate_; }  ///< frames a second of a film of those
  /// Draws a frame of those.
  void draw(const fs::path& file, int frame) const;

 private:
  using Surfaces = std::vector<vtkSmartPointer<vtkPolyData>>;

  Surfaces surfaces(int frame) const;
  void choose_colours(const Surfaces& example, const std::optional<ValueRange>& found);
  Framing whole_scene() const;

  const RenderOptions& options_;
  RunFrames frames_;
  std::string colour_;
  std::optional<EmissionTimes> emission_;
  PictureStyle style_;
  std::vector<std::uint32_t> hiding_;  // an entry a triangle of the walls
  int first_ = 0;                      // of the frames that are drawn
  std::vector<Framing> framing_;       // of each
  double rate_ = 0;
};

/// One a method.
Drawing::Surfaces Drawing::surfaces(int frame) const {
  Surfaces result;
  for (const std::string& method : frames_.methods()) {
    result.push_back(frames_.surface(method, frame));
    if (emission_) emission_->add_to(*result.back(), frame);
  }
  return result;
}

void Drawing::prepare(int first, int last) {
  const bool of_numbers = !is_texture(colour_);
  if (colour_ == kEmissionTimeArray) emission_.emplace(frames_, last);
  std::optional<ValueRange> found;
  std::vector<double> times;
  Surfaces here;
  WorkProgress progress("looking at frame", last - first + 1);
  for (int frame = first; frame <= last; ++frame) {
    progress.show(frame - first);
    here = surfaces(frame);
    times.push_back(time_of(*here.front()));
    const std::vector<vtkPolyData*> parts(here.begin(), here.end());
    framing_.push_back(liquid_framing(parts, style_.view));
    if (!of_numbers || options_.range) continue;
    for (vtkPolyData* const part : parts) found = wider(found, value_range(*part, colour_));
  }
  if (of_numbers) choose_colours(here, found);
  first_ = first;
  rate_ = options_.frames_per_second.value_or(real_time_rate(times));
  framing_ = options_.fit == Fit::scene ? std::vector(framing_.size(), whole_scene())
                                        : followed(framing_, camera_reach(rate_));
  // What hides the liquid in any of these: walls do not flicker.
  hiding_ =
      hiding_triangles(frames_, {first, first + (last - first) / 2, last}, std::array{style_.view.from});
}

void Drawing::choose_colours(const Surfaces& example, const std::optional<ValueRange>& found) {
  vtkPolyData& surface = *example.front();
  ValueRange range = options_.range ? *options_.range : *found;
  if (!options_.range && !holds_names(surface, colour_)) range = rounded(range);
  style_.colouring = colouring(surface, colour_, range);
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

void Drawing::draw(const fs::path& file, int frame) const {
  std::vector<Panel> panels;
  const Surfaces drawn = surfaces(frame);
  for (std::size_t m = 0; m < drawn.size(); ++m)
    panels.push_back({fmt::format("{},  t = {:.2f} s", frames_.methods()[m], time_of(*drawn[m])), drawn[m]});
  DrawnWalls around;
  if (const auto here = frames_.walls(frame))
    around = {part_of(*here, hiding_, false), part_of(*here, hiding_, true)};
  draw_picture(file, panels, around, framing_[static_cast<std::size_t>(frame - first_)], style_);
}

int draw_one(const RenderOptions& options, Drawing& drawing) {
  if (options.frames_per_second || options.frames)
    throw InvalidInput(fmt::format("{} is of films, whose names end in .mp4, .gif or .webp",
                                   options.frames ? "--frames" : "--fps"));
  const int frame = options.frame.value_or(drawing.frames().count() - 1);
  if (frame >= drawing.frames().count())
    throw InvalidInput(fmt::format("{} has frames 0 to {}, not {}", options.folder.string(),
                                   drawing.frames().count() - 1, frame));
  drawing.prepare(frame, frame);
  drawing.draw(options.out, frame);
  return 0;
}

FrameSpan chosen_frames(const RenderOptions& options, int count) {
  const FrameSpan frames = options.frames.value_or(FrameSpan{0, count - 1});
  if (frames.last >= count)
    throw InvalidInput(fmt::format("{} has frames 0 to {}, not {}:{}", options.folder.string(), count - 1,
                                   frames.first, frames.last));
  return frames;
}

int draw_all(const RenderOptions& options, const fs::path& film, Drawing& drawing) {
  if (options.frame) throw InvalidInput("--frame is of pictures, whose names end in .png");
  const FrameSpan frames = chosen_frames(options, drawing.frames().count());
  const int count = frames.last - frames.first + 1;
  const fs::path pictures = pictures_folder(film);
  make_folder(pictures);
  drawing.prepare(frames.first, frames.last);
  {
    WorkProgress progress("drawing frame", count);
    for (int frame = frames.first; frame <= frames.last; ++frame) {
      progress.show(frame - frames.first);
      drawing.draw(film_picture(pictures, frame), frame);
    }
  }
  remove_other_pictures(pictures, frames.first, frames.last);
  make_film(film, pictures, {frames.first, count, drawing.rate()});
  fmt::print("{}: {} frames, {:.4g} a second; each of them as a picture in {}\n", film.string(), count,
             drawing.rate(), pictures.string());
  return 0;
}

}  // namespace

std::string default_colour(const RunFrames& frames) {
  if (!is_fed(frames)) return "checker";
  const auto last = frames.surface(frames.methods().front(), frames.count() - 1);
  if (last->GetPointData()->HasArray("source") != 0)
    if (const auto [low, high] = value_range(*last, "source"); low < high) return "source";
  return kEmissionTimeArray;
}

int render(const RenderOptions& options) {
  const fs::path out = options.out.empty() ? options.folder / "film.mp4" : options.out;
  const bool film = is_film(out);
  if (!film && out.extension() != ".png")
    throw InvalidInput(fmt::format(
        "found \"{}\"; expected a file name that ends in .png, .mp4, .gif or .webp", out.string()));
  Drawing drawing(options);
  return film ? draw_all(options, out, drawing) : draw_one(options, drawing);
}

}  // namespace kappaflow
