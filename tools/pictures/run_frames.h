// The frames of a run, as pictures and pages show them.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtk_jsoncpp.h>

#include <cstdint>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "scenes/view.h"
#include "surface/measure/texture.h"
#include "tools/io/input_frame.h"
#include "tools/pictures/framing.h"

namespace kappaflow {

/// What a run folder holds of some of its methods. Files are read when they are asked for.
class RunFrames {
 public:
  /// methods: empty: all of the run. Throws InvalidInput (no such method, no frames yet), IoError (not a run
  /// folder).
  RunFrames(std::filesystem::path folder, const std::vector<std::string>& methods);

  const std::filesystem::path& folder() const { return folder_; }
  const Json::Value& record() const { return record_; }
  const std::vector<std::string>& methods() const { return methods_; }
  int count() const { return count_; }   ///< of the frames that every method has
  View view() const;                     ///< of the scene, else the default
  TextureProjection projection() const;  ///< of the scene's texture coordinates, else the default

  /// Throw IoError.
  vtkSmartPointer<vtkPolyData> surface(const std::string& method, int frame) const;
  vtkSmartPointer<vtkPolyData> walls(int frame) const;  ///< null: there are none
  bool walls_move() const;
  bool has_particles() const;
  InputFrame particles(int frame) const;                        ///< throws InvalidInput too
  vtkSmartPointer<vtkPolyData> particle_data(int frame) const;  ///< with all that their files hold

 private:
  bool has_frame(int frame) const;

  std::filesystem::path folder_;
  Json::Value record_;
  std::vector<std::string> methods_;
  int count_ = 0;
  vtkSmartPointer<vtkPolyData> walls_at_rest_;
};

/// hiding_triangles() of the first method's surface in any of these frames; none where there are no walls.
std::vector<std::uint32_t> hiding_triangles(const RunFrames& frames, const std::set<int>& at,
                                            std::span<const Vec3> viewers);

/// Of a frame [s]; 0 where the file does not say.
double time_of(vtkPolyData& surface);

/// What a camera frames of a frame's surfaces: all but some spray, with a margin.
Framing liquid_framing(std::span<vtkPolyData* const> surfaces, const View& view);

/// How many frames before and after a camera takes into account that follows the liquid, see followed().
int camera_reach(double frames_per_second);

}  // namespace kappaflow
