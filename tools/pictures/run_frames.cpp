#include "tools/pictures/run_frames.h"

#include <fmt/format.h>
#include <vtkAppendPolyData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "core/errors.h"
#include "tools/io/parallel_vtk.h"
#include "tools/io/surface_file.h"
#include "tools/pictures/hiding_walls.h"
#include "tools/runs/run_folder.h"
#include "tools/runs/run_record.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr double kFollowed = 0.5;  // how far a camera that follows looks ahead and back [s]
constexpr double kSpray = 0.002;   // share of a surface's vertices that may lie outside at each side
constexpr double kRoom = 1.1;      // around the liquid

std::vector<std::string> chosen_methods(const fs::path& folder, const std::vector<std::string>& chosen,
                                        const Json::Value& record) {
  std::vector<std::string> tracked;
  for (const Json::Value& method : record["methods"]) tracked.push_back(method.asString());
  if (chosen.empty()) return tracked;
  for (const std::string& method : chosen)
    if (std::ranges::find(tracked, method) == tracked.end())
      throw InvalidInput(fmt::format("{} has no surface tracked with \"{}\"", folder.string(), method));
  return chosen;
}

}  // namespace

RunFrames::RunFrames(fs::path folder, const std::vector<std::string>& methods)
    : folder_(std::move(folder)),
      record_(read_record(folder_)),
      methods_(chosen_methods(folder_, methods, record_)) {
  while (has_frame(count_)) ++count_;
  if (count_ == 0) throw InvalidInput(fmt::format("{} has no frames yet", folder_.string()));
  if (fs::exists(folder_ / kBoundaryFile)) walls_at_rest_ = read_surface(folder_ / kBoundaryFile);
}

bool RunFrames::has_frame(int frame) const {
  return std::ranges::all_of(methods_,
                             [&](const auto& m) { return fs::exists(folder_ / surface_file(m, frame)); });
}

View RunFrames::view() const {
  if (!record_.isMember("view")) return {};
  const auto vector = [](const Json::Value& array) {
    return Vec3(array[0].asDouble(), array[1].asDouble(), array[2].asDouble());
  };
  return {vector(record_["view"]["from"]), vector(record_["view"]["up"])};
}

TextureProjection RunFrames::projection() const {
  return value_of(kTextureProjections, record_["texture"].asString()).value_or(TextureProjection::box);
}

vtkSmartPointer<vtkPolyData> RunFrames::surface(const std::string& method, int frame) const {
  return read_surface(folder_ / surface_file(method, frame));
}

vtkSmartPointer<vtkPolyData> RunFrames::walls(int frame) const {
  const fs::path moving = folder_ / boundary_file(frame);
  return fs::exists(moving) ? read_surface(moving) : walls_at_rest_;
}

bool RunFrames::has_particles() const {
  return fs::exists(particles_of(folder_, 0)) && fs::exists(particles_of(folder_, count_ - 1));
}

InputFrame RunFrames::particles(int frame) const {
  return read_input_frame(particles_of(folder_, frame));
}

vtkSmartPointer<vtkPolyData> RunFrames::particle_data(int frame) const {
  const std::vector<fs::path> pieces = pieces_of(particles_of(folder_, frame));
  if (pieces.size() == 1) return read_surface(pieces.front());
  const vtkNew<vtkAppendPolyData> all;
  for (const fs::path& piece : pieces) all->AddInputData(read_surface(piece));
  all->Update();
  return all->GetOutput();
}

bool RunFrames::walls_move() const {
  return fs::exists(folder_ / boundary_file(0));
}

std::vector<std::uint32_t> hiding_triangles(const RunFrames& frames, const std::set<int>& at,
                                            std::span<const Vec3> viewers) {
  std::vector<std::uint32_t> any;
  for (const int frame : at) {
    const auto walls = frames.walls(frame);
    if (!walls) continue;
    const std::vector<std::uint32_t> here =
        hiding_triangles(*walls, *frames.surface(frames.methods().front(), frame), viewers);
    any.resize(here.size());
    std::ranges::transform(here, any, any.begin(), std::bit_or());
  }
  return any;
}

double time_of(vtkPolyData& surface) {
  vtkDataArray* const time = surface.GetFieldData()->GetArray("TimeValue");
  const double value = time != nullptr && time->GetNumberOfValues() > 0 ? time->GetComponent(0, 0) : 0;
  return std::isfinite(value) ? value : 0;
}

Framing liquid_framing(std::span<vtkPolyData* const> surfaces, const View& view) {
  Framing liquid = framing(surfaces, view, kSpray);
  liquid.half *= kRoom;
  return liquid;
}

int camera_reach(double frames_per_second) {
  return static_cast<int>(kFollowed * frames_per_second);
}

}  // namespace kappaflow
