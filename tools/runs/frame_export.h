// The files of a run that other programs open: OBJ, PLY, GLB and USD, beside VTK's.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <functional>
#include <string>
#include <vector>

#include "tools/io/exported_arrays.h"
#include "tools/io/mesh_formats.h"
#include "tools/io/usd_walls.h"

namespace kappaflow {

/// What of a run is the same in all frames.
struct ExportSettings {
  std::vector<MeshFormat> formats;
  std::vector<std::string> methods;  ///< what files call the surfaces
  double frames_per_second = 25;
  Vec3 up{0, 1, 0};                               ///< z where that is its largest component, else y
  TextureMap texture{};                           ///< by the first mesh
  Vec3 origin = Vec3::Zero();                     ///< far_origin() of the first mesh
  vtkSmartPointer<vtkPolyData> walls_at_start{};  ///< as boundary_data() has them; null: there are none
  bool walls_move = false;
  bool has_particles = true;
};

/// Turns the data of a run's own files into the contents of the others. Of a USD scene every frame has its
/// files, and then the roots are written anew: what they list is there and complete, at any moment.
class FrameExport {
 public:
  /// name: relative to the run folder, or to another one that gets the same layout.
  using Write = std::function<void(const std::string& name, const std::string& content)>;

  FrameExport(ExportSettings settings, Write write);

  bool asked_for() const { return !settings_.formats.empty(); }
  void write_surface(int frame, const std::string& method, vtkPolyData& surface) const;
  void write_particles(int frame, vtkPolyData& particles) const;
  void write_walls(int frame, vtkPolyData& walls) const;  ///< that move
  /// When all of the frame's data have been written.
  void finish_frame(int frame) const;

 private:
  bool has_usd() const;
  void write_common_files() const;
  void write_roots(int frames) const;

  ExportSettings settings_;
  UsdStage stage_;
  std::vector<UsdWall> walls_;
  Write write_;
};

}  // namespace kappaflow
