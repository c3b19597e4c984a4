// Another program's surfaces as images of their distance, whether it wrote images or meshes.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "surface/field/distance_field.h"
#include "tools/io/frame_sequence.h"
#include "tools/io/input_kind.h"

namespace kappaflow {

/// Images are taken as they are, those of .vdb files on one grid for all. The distances of meshes are taken
/// on a grid as fine as the first mesh is, so far away that they say how the surface moves from frame to
/// frame, in whatever frame it moves most.
class DistanceSequence {
 public:
  /// kind: images or meshes. Reads and checks all files, as FrameSequence does. Throws InvalidInput where the
  /// first image has nothing inside, and for meshes that pass through themselves.
  DistanceSequence(const FileSeries& series, InputKind kind, std::optional<double> frames_per_second,
                   const std::function<void(std::size_t file)>& watch);

  const FileSeries& series() const;
  const std::string& hash() const;
  const std::vector<std::string>& notes() const { return notes_; }
  std::size_t size() const { return series().files.size(); }
  double time(std::size_t frame) const;  ///< [s]
  bool has_velocity() const { return has_velocity_; }
  double spacing() const { return spacing_; }  ///< of the grid, the widest [m]

  /// The motion from a frame to the next. Throws InvalidInput where the surface moves further than its
  /// distances reach.
  DistanceMotion motion_from(std::size_t frame);

 private:
  using Image = DistanceMotion::Image;

  void take_images(const ImageSequence& images);
  void take_meshes(const MeshSequence& meshes);
  Image image(std::size_t frame);
  Image make_image(ImageFrame frame, double time) const;

  std::variant<ImageSequence, MeshSequence> frames_;
  std::vector<std::string> notes_;
  Vec3 origin_ = Vec3::Zero();  // of the first image [m]
  double spacing_ = 0;
  bool has_velocity_ = false, positive_inside_ = false;
  double reach_ = 0;                                  // of meshes' distances [m]
  std::deque<std::pair<std::size_t, Image>> images_;  // those made last
};

}  // namespace kappaflow
