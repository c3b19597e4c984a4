// Sequences of a block of particles in a known motion, and what `track` makes of them.
#pragma once

#include <gtest/gtest.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "tests/tools/scratch.h"
#include "tests/tools/sequence_files.h"
#include "tests/vtk_reader.h"
#include "tools/runs/track.h"

namespace kappaflow {

/// At 10 a second: the body moves 0.3 m, 3 of its spacings, and turns 0.67 rad.
inline constexpr int kFrames = 6;
inline constexpr double kSigma = 0.2, kThreshold = 2.5;

/// All that a run wrote but what names its input, or says how long it took.
inline std::set<std::filesystem::path> results_in(const std::filesystem::path& run) {
  namespace fs = std::filesystem;
  std::set<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(run))
    if (!entry.is_directory()) files.insert(fs::relative(entry.path(), run));
  for (const char* name : {"run.json", "timings.csv", "checkpoint.bin"}) EXPECT_EQ(files.erase(name), 1);
  return files;
}

class Track : public Scratch {
 protected:
  template <class Text>
  void write_sequence(const std::string& ending, const SteadyMotion& motion, double frame_time,
                      const Text& text, int frames = kFrames) {
    for (int k = 0; k < frames; ++k)
      file(fmt::format("p_{}.{}", k + 6, ending),
           text(moved_block(motion, frame_time * k), k));  // to 10 and 11
  }
  TrackOptions options_for(const std::string& pattern, std::vector<std::string> methods) const {
    TrackOptions o;
    o.inputs = {(folder / pattern).string()};
    o.folder = folder / "out";
    o.methods = std::move(methods);
    o.force = o.quiet = true;
    return o;
  }
  /// The same, of the block of particles.
  TrackOptions options(const std::string& pattern, std::vector<std::string> methods) const {
    TrackOptions o = options_for(pattern, std::move(methods));
    o.frames_per_second = 10;
    o.sigma = kSigma;
    o.threshold = kThreshold;
    o.edge_length = 0.5 * kSigma;
    return o;
  }
  vtkSmartPointer<vtkPolyData> surface(const std::string& method, int frame) const {
    return read_vtp(folder / "out" / fmt::format("surface-{}/surface_{:04}.vtp", method, frame));
  }
  /// Mean distance of the vertices of a frame from where moved(rest position) says that they are [m].
  template <class Moved>
  double mean_error(const std::string& method, int frame, const Moved& moved) const {
    const auto mesh = surface(method, frame);
    vtkDataArray& rest = *mesh->GetPointData()->GetArray("rest_position");
    double sum = 0;
    for (vtkIdType v = 0; v < mesh->GetNumberOfPoints(); ++v)
      sum += (Vec3(mesh->GetPoint(v)) - moved(Vec3(rest.GetTuple3(v)))).norm();
    return sum / static_cast<double>(mesh->GetNumberOfPoints());
  }
  /// The largest distance of a vertex from where the motion takes its rest position, in sigma. Vertices that
  /// edits of the mesh made have a blend for rest position, and no vote.
  double largest_error(const std::string& method, const SteadyMotion& motion, double time) const {
    const auto mesh = surface(method, kFrames - 1);
    const auto first_vertices = static_cast<double>(surface(method, 0)->GetNumberOfPoints());
    vtkDataArray& rest = *mesh->GetPointData()->GetArray("rest_position");
    vtkDataArray& id = *mesh->GetPointData()->GetArray("id");
    double largest = 0;
    for (vtkIdType v = 0; v < mesh->GetNumberOfPoints(); ++v) {
      if (id.GetTuple1(v) >= first_vertices) continue;
      const Vec3 expected = motion.position(Vec3(rest.GetTuple3(v)), time);
      largest = std::max(largest, (Vec3(mesh->GetPoint(v)) - expected).norm());
    }
    return mesh->GetNumberOfPoints() > 200 ? largest / kSigma : 1e9;
  }
};

}  // namespace kappaflow
