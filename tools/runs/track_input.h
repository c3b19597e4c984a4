// What `kappaflow track` tracks: a series of files with all that follows from it and the options.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scenes/scene.h"
#include "tools/io/file_series.h"
#include "tools/io/input_kind.h"
#include "tools/runs/frame_source.h"
#include "tools/runs/track.h"

namespace kappaflow {

/// Read and checked; frames() and what else is asked for may read files again.
class TrackInput {
 public:
  virtual ~TrackInput() = default;

  virtual const FileSeries& series() const = 0;
  virtual const std::string& hash() const = 0;                ///< of all that is read, to recognise it by
  virtual const std::vector<std::string>& notes() const = 0;  ///< what a user should know, a sentence each
  virtual double time(std::size_t frame) const = 0;           ///< [s]

  virtual const SurfaceDescription& surface() const = 0;  ///< how it is meshed and tracked
  virtual double length_scale() const = 0;                ///< sigma [m]
  virtual std::optional<double> threshold() const = 0;    ///< of Eq. 12; nullopt where there is none

  /// Throws InvalidInput where frames move too far for what is known of them.
  virtual void check_motion() {}
  /// With the first mesh. with_tracers: whether tracers follow the material.
  virtual std::unique_ptr<FrameSource> frames(bool with_tracers) = 0;
  /// Lines for the terminal: what the surfaces are of.
  virtual std::string setup_text() const = 0;
  /// Likewise, once there are surfaces; mostly empty.
  virtual std::string warning(const FrameSource& /*frames*/) const { return {}; }

  const std::string& name() const { return series().name; }
  std::size_t size() const { return series().files.size(); }
};

/// Called before each file with its number from 0.
using FileWatch = std::function<void(std::size_t file)>;

/// Of particles, images of distances or meshes: input_kind() of the first frame. Throws what reading them
/// throws, and InvalidInput for options that do not fit them.
std::unique_ptr<TrackInput> open_input(const FileSeries& series, const TrackOptions& options,
                                       const FileWatch& watch);

/// Parts of it.
std::unique_ptr<TrackInput> particle_input(const FileSeries& series, const TrackOptions& options,
                                           const FileWatch& watch);
std::unique_ptr<TrackInput> distance_input(const FileSeries& series, InputKind kind,
                                           const TrackOptions& options, const FileWatch& watch);

/// The mesh's edge in length scales that options ask for. Throws InvalidInput where it is none that a mesh
/// can have.
double edge_length_in(double length_scale, const TrackOptions& options);

}  // namespace kappaflow
