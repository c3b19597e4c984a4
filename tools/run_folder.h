// The files of one run: their names, their places, and what happens when they are already there.
#pragma once

#include <vtkPolyData.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tools/folder_lock.h"
#include "tools/mesh_text.h"

namespace kappaflow {

/// What a frame adds to the tables; whole lines.
struct FrameRows {
  std::string metrics, pieces, timings;
};

/// A run folder:
///   run.json  metrics.csv  pieces.csv  timings.csv  run.pvd
///   boundary.vtp, or where walls move boundary.pvd  boundary/boundary_0000.vtp ...
///   particles.pvd  particles/particles_0000.vtp ...
///   surface-<method>.pvd  surface-<method>/surface_0000.vtp ... (and .obj, .ply, .glb where these are asked
///   for)
/// Whatever is there under these names is complete and listed in the .pvd files, at any moment of the run.
class RunFolder {
 public:
  /// Makes the folder and its tables. Throws InvalidInput when the folder already holds a run (a run.json)
  /// and `force` is not set (with it, the old run's files are removed, and nothing else) or another run is
  /// writing into it, IoError when the folder cannot be written.
  RunFolder(std::filesystem::path folder, std::vector<std::string> methods, bool force);

  const std::filesystem::path& path() const { return folder_; }

  void write_record(const std::string& json);
  /// Of all frames.
  void write_boundary(vtkPolyData& data);
  /// Of one frame of moving walls; for every frame or none.
  void write_boundary(int frame, vtkPolyData& data);
  void write_particles(int frame, vtkPolyData& data);
  void write_surface(int frame, const std::string& method, vtkPolyData& data);
  /// A further file of the same surface, beside its .vtp.
  void write_mesh(int frame, const std::string& method, MeshFormat format, const std::string& bytes);
  /// Lists the frame's files at `time` [s] in the .pvd files and appends its rows to the tables.
  void finish_frame(double time, const FrameRows& rows);

 private:
  void write_collections() const;

  std::filesystem::path folder_;
  FolderLock lock_;
  std::vector<std::string> methods_;
  std::vector<double> times_;  // of the finished frames [s]
  bool has_boundary_ = false, boundary_moves_ = false;
};

/// The file of a frame relative to the run folder.
std::string particle_file(int frame);
std::string surface_file(const std::string& method, int frame);
std::string boundary_file(int frame);
inline constexpr const char* kBoundaryFile = "boundary.vtp";  ///< of walls at rest
inline constexpr const char* kRecordFile = "run.json";

}  // namespace kappaflow
