#include "tools/pictures/render.h"

#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkStaticCellLocator.h>
#include <vtk_jsoncpp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <string_view>

#include "core/errors.h"
#include "core/quantile.h"
#include "tools/io/files.h"
#include "tools/io/surface_file.h"
#include "tools/pictures/film.h"
#include "tools/pictures/picture.h"
#include "tools/runs/progress.h"
#include "tools/runs/run_folder.h"
#include "tools/runs/run_record.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr double kHidden = 0.3;  // share of a surface that walls hide at most without being seen through
constexpr double kGlass = 0.25;  // the opacity of walls that hide more
constexpr vtkIdType kRays = 500;
constexpr double kFallbackRate = 25;  // frames a second, where a run has one frame only

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
    if (fs::exists(options.folder / kBoundaryFile))
      walls_at_rest_ = read_surface(options.folder / kBoundaryFile);
    const std::array<Sight, 2> ends{sight(0), sight(frames_ - 1)};
    subject_ = subject_of(ends);
    if (std::max(hidden_share(ends[0]), hidden_share(ends[1])) > kHidden) style_.wall_opacity = kGlass;
  }

  int frames() const { return frames_; }
  /// Fixes the colours for frames [first, last].
  void choose_colours(int first, int last);
  /// Returns the frame's time [s].
  double draw(const fs::path& file, int frame) const;

 private:
  /// What a frame shows: walls, perhaps none, and the first method's surface.
  struct Sight {
    vtkSmartPointer<vtkPolyData> walls, liquid;
  };

  bool has_frame(int frame) const {
    return std::ranges::all_of(
        methods_, [&](const auto& m) { return fs::exists(options_.folder / surface_file(m, frame)); });
  }
  vtkSmartPointer<vtkPolyData> surface(const std::string& method, int frame) const {
    return read_surface(options_.folder / surface_file(method, frame));
  }
  vtkSmartPointer<vtkPolyData> walls(int frame) const;
  Sight sight(int frame) const { return {walls(frame), surface(methods_.front(), frame)}; }
  static vtkSmartPointer<vtkPolyData> subject_of(std::span<const Sight> sights);
  double hidden_share(const Sight& here) const;

  const RenderOptions& options_;
  Json::Value record_;
  std::vector<std::string> methods_;
  int frames_ = 0;
  PictureStyle style_;
  vtkSmartPointer<vtkPolyData> walls_at_rest_, subject_;
};

vtkSmartPointer<vtkPolyData> Drawing::walls(int frame) const {
  const fs::path moving = options_.folder / boundary_file(frame);
  return fs::exists(moving) ? read_surface(moving) : walls_at_rest_;
}

/// What fills the picture, the same in every frame: walls and first surface in the first and the last frame.
vtkSmartPointer<vtkPolyData> Drawing::subject_of(std::span<const Sight> sights) {
  auto points = vtkSmartPointer<vtkPoints>::New();
  for (const Sight& here : sights)
    for (const auto& part : {here.walls, here.liquid})
      if (part && part->GetNumberOfPoints() > 0)
        points->InsertPoints(points->GetNumberOfPoints(), part->GetNumberOfPoints(), 0, part->GetPoints());
  auto subject = vtkSmartPointer<vtkPolyData>::New();
  subject->SetPoints(points);
  return subject;
}

/// The share of the first surface's vertices, of some hundreds, that a wall hides from the viewer.
double Drawing::hidden_share(const Sight& here) const {
  const auto& [around, liquid] = here;
  const vtkIdType vertices = liquid->GetNumberOfPoints();
  if (!around || around->GetNumberOfCells() == 0 || vertices == 0) return 0;
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(around);
  locator->BuildLocator();
  const Vec3 to_viewer = 2 * subject_->GetLength() * style_.view.from.normalized();
  const vtkIdType stride = 1 + vertices / kRays;
  int rays = 0, hidden = 0;
  for (vtkIdType v = 0; v < vertices; v += stride, ++rays) {
    const Vec3 from(liquid->GetPoint(v)), to = from + to_viewer;
    double along = 0;
    Vec3 at, coordinates;
    int part = 0;
    hidden +=
        locator->IntersectWithLine(from.data(), to.data(), 0, along, at.data(), coordinates.data(), part);
  }
  return static_cast<double>(hidden) / rays;
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
  style_.colouring = colouring(*example, options_.colour, range);
}

double time_of(vtkPolyData& surface) {
  vtkDataArray* const time = surface.GetFieldData()->GetArray("TimeValue");
  const double value = time != nullptr && time->GetNumberOfValues() > 0 ? time->GetComponent(0, 0) : 0;
  return std::isfinite(value) ? value : 0;
}

double Drawing::draw(const fs::path& file, int frame) const {
  std::vector<Panel> panels;
  double time = 0;
  for (const std::string& method : methods_) {
    const auto drawn = surface(method, frame);
    time = time_of(*drawn);
    panels.push_back({fmt::format("{},  t = {:.2f} s", method, time), drawn});
  }
  draw_picture(file, panels, walls(frame), subject_, style_);
  return time;
}

int draw_one(const RenderOptions& options, Drawing& drawing) {
  if (options.frames_per_second) throw InvalidInput("--fps is of films, whose names end in .mp4");
  const int frame = options.frame.value_or(drawing.frames() - 1);
  if (frame >= drawing.frames())
    throw InvalidInput(
        fmt::format("{} has frames 0 to {}, not {}", options.folder.string(), drawing.frames() - 1, frame));
  drawing.choose_colours(frame, frame);
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
  drawing.choose_colours(0, drawing.frames() - 1);
  std::vector<double> times;
  for (int frame = 0; frame < drawing.frames(); ++frame) {
    draw_status_line(fmt::format("frame {}/{}", frame, drawing.frames() - 1));
    times.push_back(drawing.draw(film_picture(pictures, frame), frame));
  }
  draw_status_line("");
  remove_pictures_from(pictures, drawing.frames());
  const double rate = options.frames_per_second.value_or(real_time_rate(times));
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
