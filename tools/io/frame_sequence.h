// Images or meshes of another program's simulation, frame by frame.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tools/io/file_series.h"
#include "tools/io/image_file.h"
#include "tools/io/surface_mesh_file.h"

namespace kappaflow {

/// A series of files with an image, or a piece of one, or a mesh each, checked when it is opened and then
/// given frame by frame.
template <class Frame>
class FrameSequence {
 public:
  /// Reads every file, and keeps none. frames_per_second: where the files hold no times; the first one is
  /// then at 0 s. Throws what read_image() or read_mesh_frame() throws, and InvalidInput where times do not
  /// ascend, there are no times at all, a file seems to be missing, or an image has velocities and another
  /// has none, or other points than the first (of .vdb: another spacing).
  /// watch: called before each file with its number from 0.
  FrameSequence(FileSeries series, std::optional<double> frames_per_second,
                const std::function<void(std::size_t file)>& watch = {});

  const FileSeries& series() const { return series_; }
  const std::string& name() const { return series_.name; }
  std::size_t size() const { return series_.files.size(); }
  const std::filesystem::path& file(std::size_t frame) const { return series_.files[frame]; }
  double time(std::size_t frame) const { return time_[frame]; }  ///< [s]
  /// What a user should know about the files, a sentence or so each.
  const std::vector<std::string>& notes() const { return notes_; }
  /// Of all that is read from the files, to recognise them by.
  const std::string& hash() const { return hash_; }

  /// Reads a frame; its time is that of the file, see time(). Backward its velocities have the other sign.
  Frame frame(std::size_t frame) const;

 private:
  FileSeries series_;
  std::vector<double> time_;
  std::vector<std::string> notes_;
  std::string hash_;
};

extern template class FrameSequence<ImageFrame>;
extern template class FrameSequence<MeshFrame>;
using ImageSequence = FrameSequence<ImageFrame>;
using MeshSequence = FrameSequence<MeshFrame>;

}  // namespace kappaflow
