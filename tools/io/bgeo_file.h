// Particle files of Partio and older versions of Houdini (.bgeo, version 5), as SPlisHSPlasH writes them.
#pragma once

#include <filesystem>

#include "tools/io/point_data.h"

namespace kappaflow {

/// Reads the points of a file, compressed by gzip or not: "BgeoV", then big-endian the version 5, the
/// numbers of points, primitives, groups and attributes, what attributes the points have, and the points,
/// each its position x, y, z, w and its attributes: floats, vectors and integers. What follows them is not
/// read. Throws IoError where the file cannot be read, is damaged or not complete.
PointData read_bgeo(const std::filesystem::path& file);

}  // namespace kappaflow
