// The files of one run: their names, their places, and what happens when they are already there.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <future>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tools/io/folder_lock.h"
#include "tools/runs/metrics.h"

namespace kappaflow {

/// What a frame adds to the tables; whole lines.
struct FrameRows {
  std::string metrics, pieces, timings;
  std::string bodies = {};  ///< in every frame, or in none
};

/// A run folder:
///   run.json  run.toml  checkpoint.bin  metrics.csv  pieces.csv  timings.csv  run.pvd
///   bodies.csv, where there are bodies
///   boundary.vtp, or where walls move boundary.pvd  boundary/boundary_0000.vtp ...
///   particles.pvd  particles/particles_0000.vtp ...
///     or where ranks write them particles/particles_0000.pvtp ...  particles/particles_0000_0.vtp ...
///   surface-<method>.pvd  surface-<method>/surface_0000.vtp ...
/// and where they are asked for, see frame_export.h:
///   surface-<method>/surface_0000.obj ... (.ply, .glb)
///   run.usda  boundary.usda  particles.usda  surface-<method>.usda, and .usda files in these folders
/// Whatever is there under these names is complete and listed in the .pvd files, at any moment of the run.
///
/// Files are written beside the computation, in the order of the calls: write_...() return at once and keep
/// their data until the frame is finished. Where one cannot be written nothing is after it, and wait() says
/// so.
class RunFolder {
 public:
  /// Makes the folder and its tables. Throws InvalidInput when the folder already holds a run (a run.json, or
  /// files in folders of those names) and `force` is not set, or another run is writing into it, IoError when
  /// the folder cannot be written. With `force` the new run begins in a folder inside, until take_place().
  RunFolder(std::filesystem::path folder, std::vector<std::string> methods, bool force);
  /// Opens the folder of a run that was interrupted; what else there is to know, serialize() reads. Throws
  /// InvalidInput when another run is writing into it, IoError when there is no such folder.
  explicit RunFolder(std::filesystem::path folder);
  /// Waits for what is being written. A run that did not come to take its place leaves the one that it was to
  /// replace as it was.
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::filesystem::path& path() const { return folder_; }
  /// Where files are written now: path(), or inside of it until take_place().
  const std::filesystem::path& place() const { return place_; }

  /// To be called when the run has really begun: its first frame is written. The files of the run that the
  /// folder held are removed, and nothing else, and those of the new one come in their place.
  void take_place();

  void write_record(const std::string& json);
  /// A copy of the scene, for resuming the run.
  void write_scene(const std::string& text);
  /// Of all frames.
  void write_boundary(vtkSmartPointer<vtkPolyData> data);
  /// Of one frame of moving walls; for every frame or none.
  void write_boundary(int frame, vtkSmartPointer<vtkPolyData> data);
  void write_particles(int frame, vtkSmartPointer<vtkPolyData> data);
  /// The particle_list() of so many pieces that some of the ranks have written. like: with the same arrays.
  /// Throws IoError where they are not all there.
  void list_particles(int frame, int ranks, int count, vtkPolyData& like);
  void write_surface(int frame, const std::string& method, vtkSmartPointer<vtkPolyData> data);
  /// Does what `work` does in its turn among the files; it may call write_export() and nothing else of this.
  void beside(std::function<void()> work);
  /// A file for other programs, at once; name: relative to the folder.
  void write_export(const std::string& name, const std::string& content);
  /// Lists the frame's files at `time` [s] in the .pvd files and appends its rows to the tables.
  void finish_frame(double time, const FrameRows& rows);
  /// A checkpoint, once everything before it is on the disk, where a power cut leaves it.
  void write_checkpoint(std::string state);
  /// Returns when all of the above is done. Throws what went wrong first: IoError.
  void wait();

  /// Of a resumed run: the frames that are there already, which serialize() leaves to the caller.
  void set_times(std::vector<double> times);

  std::vector<MetricsRow> metrics() const;

  /// See core/saved_state.h. Reading cuts the tables back to the rows that they had.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(methods_, has_boundary_, boundary_moves_, table_lines_);
    if constexpr (Archive::is_loading::value) cut_tables();
  }

 private:
  void start_work();
  void write_data(const std::string& name, vtkSmartPointer<vtkPolyData> data);
  void write_text(const std::string& name, std::string text);
  void list_pieces(int frame, std::vector<std::string> pieces, vtkPolyData& like);
  void write_now(const std::filesystem::path& file, const std::string& text);
  void flush();
  void write_collections();
  void cut_tables() const;

  std::filesystem::path folder_;
  FolderLock lock_;
  std::filesystem::path place_;
  std::vector<std::string> methods_;
  std::vector<double> times_;  // of the finished frames [s]
  std::set<int> in_pieces_;    // frames whose particles are

  std::array<std::uint64_t, 4> table_lines_{};  // of metrics, pieces, timings and bodies; 0: there is none
  bool has_boundary_ = false, boundary_moves_ = false;
  bool has_particles_ = false;               // in the frame that is being written
  std::set<std::filesystem::path> written_;  // since the last flush; of the work beside
  std::vector<std::function<void()>> work_;  // that waits for the end of the frame
  std::shared_future<void> last_work_;       // each frame's waits for that of the one before it
};

/// Whether it is one of the folders inside of a run folder, there or to come.
bool is_run_folder(const std::filesystem::path& folder);

/// The file of a frame relative to the run folder.
std::string particle_file(int frame);
std::string particle_list(int frame);             ///< where they are in pieces
std::string particle_piece(int frame, int rank);  ///< of those

std::string surface_file(const std::string& method, int frame);
std::string boundary_file(int frame);
/// Of that run: particle_list() where it is there, else particle_file().
std::filesystem::path particles_of(const std::filesystem::path& run, int frame);
inline constexpr const char* kBoundaryFile = "boundary.vtp";  ///< of walls at rest
inline constexpr const char* kRecordFile = "run.json";
inline constexpr const char* kMetricsFile = "metrics.csv";
inline constexpr const char* kTimingsFile = "timings.csv";
inline constexpr const char* kSceneFile = "run.toml";  ///< a copy of the scene
inline constexpr const char* kCheckpointFile = "checkpoint.bin";
inline constexpr const char* kFailureFile = "failure.vtp";  ///< the particles when a simulation failed

}  // namespace kappaflow
