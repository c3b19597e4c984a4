#include "tools/pictures/emission.h"

#include <fmt/format.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>
#include <vector>

#include "core/errors.h"
#include "core/nearest_points.h"
#include "tools/runs/run_folder.h"

namespace kappaflow {
namespace {

FileSeries particle_files(const RunFrames& frames, int last) {
  FileSeries series;
  for (int frame = 0; frame <= last; ++frame) series.files.push_back(particles_of(frames.folder(), frame));
  return series;
}

}  // namespace

bool is_fed(const RunFrames& frames) {
  if (!frames.has_particles()) return false;
  // Of large frames those near the surface are kept: which these are says nothing of when they came.
  if (!frames.particles(0).radius.empty()) return false;
  std::vector<std::int64_t> first = frames.particles(0).id, last = frames.particles(frames.count() - 1).id;
  std::ranges::sort(first);
  std::ranges::sort(last);
  return !std::ranges::includes(first, last);
}

EmissionTimes::EmissionTimes(const RunFrames& frames, int last)
    : folder_(frames.folder()), frames_(particle_files(frames, last)) {
  double before = 0;
  for (int frame = 0; frame <= last; ++frame) {
    const InputFrame& here = particles(frame);
    const double now = here.time.value_or(frame);
    std::vector<std::int64_t> come;
    for (const std::int64_t id : here.id)
      if (!time_.contains(id)) come.push_back(id);
    std::ranges::sort(come);
    if (frame == 0) before = now;
    for (std::size_t k = 0; k < come.size(); ++k)
      time_[come[k]] =
          before + (now - before) * static_cast<double>(k + 1) / static_cast<double>(come.size());
    before = now;
  }
}

const InputFrame& EmissionTimes::particles(int frame) const {
  const InputFrame& found = frames_[static_cast<std::size_t>(frame)];
  if (found.id.empty())
    throw InvalidInput(fmt::format("{} does not say which particle is which, so nobody knows when each came",
                                   folder_.string()));
  return found;
}

void EmissionTimes::add_to(vtkPolyData& surface, int frame) const {
  const InputFrame& here = particles(frame);
  std::vector<Vec3> places;
  for (vtkIdType v = 0; v < surface.GetNumberOfPoints(); ++v) places.emplace_back(surface.GetPoint(v));
  vtkNew<vtkFloatArray> times;
  times->SetName(kEmissionTimeArray);
  for (const std::uint32_t nearest : nearest_points(here.position, places))
    times->InsertNextValue(static_cast<float>(time_.at(here.id[nearest])));
  surface.GetPointData()->AddArray(times);
}

}  // namespace kappaflow
