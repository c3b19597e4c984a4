#include "tools/render.h"

#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkPoints.h>
#include <vtk_jsoncpp.h>

#include <algorithm>
#include <memory>
#include <string_view>

#include "core/errors.h"
#include "tools/data_files.h"
#include "tools/files.h"
#include "tools/picture.h"
#include "tools/run_folder.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

/// The methods that run.json names.
std::vector<std::string> methods_of_run(const fs::path& folder) {
  const fs::path file = folder / kRecordFile;
  const std::string text = read_file(file);
  Json::Value record;
  std::string errors;
  const std::unique_ptr<Json::CharReader> reader(Json::CharReaderBuilder().newCharReader());
  if (!reader->parse(text.data(), text.data() + text.size(), &record, &errors) ||
      !record["methods"].isArray())
    throw IoError(file.string(), "is not the record of a run");
  std::vector<std::string> methods;
  for (const Json::Value& method : record["methods"]) methods.push_back(method.asString());
  return methods;
}

std::vector<std::string> chosen_methods(const RenderOptions& options) {
  std::vector<std::string> tracked = methods_of_run(options.folder);
  if (options.methods.empty()) return tracked;
  for (const std::string& method : options.methods)
    if (std::ranges::find(tracked, method) == tracked.end())
      throw InvalidInput(
          fmt::format("{} has no surface tracked with \"{}\"", options.folder.string(), method));
  return options.methods;
}

bool has_frame(const fs::path& folder, const std::vector<std::string>& methods, int frame) {
  return std::ranges::all_of(methods,
                             [&](const auto& m) { return fs::exists(folder / surface_file(m, frame)); });
}

int frame_count(const fs::path& folder, const std::vector<std::string>& methods) {
  int frames = 0;
  while (has_frame(folder, methods, frames)) ++frames;
  return frames;
}

int chosen_frame(const RenderOptions& options, const std::vector<std::string>& methods) {
  const int frames = frame_count(options.folder, methods);
  if (options.frame < frames && frames > 0) return options.frame >= 0 ? options.frame : frames - 1;
  throw InvalidInput(frames == 0 ? fmt::format("{} has no frames yet", options.folder.string())
                                 : fmt::format("{} has frames 0 to {}, not {}", options.folder.string(),
                                               frames - 1, options.frame));
}

/// The points of the first method's surface in the first and the last frame.
vtkSmartPointer<vtkPolyData> both_ends(const fs::path& folder, const std::vector<std::string>& methods) {
  auto first = read_vtp(folder / surface_file(methods.front(), 0));
  const auto last = read_vtp(folder / surface_file(methods.front(), frame_count(folder, methods) - 1));
  const vtkIdType offset = first->GetNumberOfPoints();
  first->GetPoints()->InsertPoints(offset, last->GetNumberOfPoints(), 0, last->GetPoints());
  return first;
}

double time_of(vtkPolyData& surface) {
  vtkDataArray* const time = surface.GetFieldData()->GetArray("TimeValue");
  return time != nullptr ? time->GetTuple1(0) : 0;
}

}  // namespace

void render(const RenderOptions& options) {
  const std::vector<std::string> methods = chosen_methods(options);
  const int frame = chosen_frame(options, methods);
  std::vector<Panel> panels;
  panels.reserve(methods.size());
  for (const std::string& method : methods) {
    const auto surface = read_vtp(options.folder / surface_file(method, frame));
    panels.push_back({fmt::format("{},  t = {:.2f} s", method, time_of(*surface)), surface});
  }
  const fs::path moving = options.folder / boundary_file(frame);
  const fs::path boundary = fs::exists(moving) ? moving : options.folder / kBoundaryFile;
  const auto walls = fs::exists(boundary) ? read_vtp(boundary) : nullptr;
  // What fills the picture: the walls, or without walls the first surface at both ends of its way; the same
  // in every frame of a run.
  const auto subject = walls ? walls : both_ends(options.folder, methods);
  draw_picture(options.picture, panels, walls, subject, {.columns = options.columns});
}

}  // namespace kappaflow
