// Images of distances that lie in several files.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "tools/io/image_file.h"
#include "tools/io/lattice_box.h"

namespace kappaflow {

/// Reads an image of one file, or of several, the pieces that the ranks of a distributed solver wrote. Throws
/// what read_image() of a file and join_pieces() throw.
ImageFrame read_image(std::span<const std::filesystem::path> files);

struct ImagePiece {
  std::filesystem::path file{};
  ImageFrame frame{};                  ///< of any size; of a plane of points there are no cells
  bool of_cells = false;               ///< what the values belong to, else points
  std::vector<bool> ghost{};           ///< of each value whether another piece has it as well; empty: unknown
  std::optional<LatticeBox> points{};  ///< which it is there for, where a list says it
};

/// What a list says of the whole.
struct ImageLattice {
  Vec3 origin = Vec3::Zero();   ///< of point 0 [m]
  Vec3 spacing = Vec3::Ones();  ///< [m], > 0
  LatticeBox points{};
};

/// The image of which these are the pieces; where no list says how large it is, the box around them. They may
/// overlap: a value comes from the last piece that has it and does not call it a ghost, else from the last
/// one that has it. file: that stands for the frame, in messages. Throws InvalidInput where pieces have
/// other arrays, times or lattices than the first, or a number that is not finite, or leave a gap.
ImagePiece join_pieces(std::span<const ImagePiece> pieces, const std::optional<ImageLattice>& whole,
                       const std::filesystem::path& file);

}  // namespace kappaflow
