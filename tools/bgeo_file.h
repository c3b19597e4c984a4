// Particle files of Partio and older versions of Houdini (.bgeo, version 5), as SPlisHSPlasH writes them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// The points of a file with their numbers.
struct BgeoPoints {
  struct Attribute {
    std::string name;
    std::size_t components;
    std::vector<double> value;  ///< components entries a point
  };
  std::vector<Vec3> position;
  std::vector<Attribute> attributes;  ///< of floats, vectors and integers

  /// The attribute of that name and size; null where there is none.
  const Attribute* find(const std::string& name, std::size_t components) const;
};

/// Reads the points of a file, compressed by gzip or not: "BgeoV", then big-endian the version 5, the
/// numbers of points, primitives, groups and attributes, what attributes the points have, and the points,
/// each its position x, y, z, w and its attributes. What follows them is not read.
/// Throws IoError where the file cannot be read, is damaged or not complete.
BgeoPoints read_bgeo(const std::filesystem::path& file);

}  // namespace kappaflow
