// Level sets in OpenVDB's files.
//
// C++17, and so is all that this includes: OpenVDB 10's own headers are not C++20, with the concepts that
// oneTBB then asks for.
#pragma once

#include <filesystem>

#include "tools/io/image_file.h"

namespace kappaflow {

/// How far distances reach beyond those in the file at least [voxels].
inline constexpr int kVdbReach = 10;

/// The grid of floats surface, phi or sdf, in upper or lower case, else the only level set, else the only
/// grid of floats, as a dense lattice around its active voxels. Its distances go on by fast sweeping (Zhao
/// 2005), of first order, kVdbReach voxels further on both sides than in the file; where there is none they
/// are the largest. The time is the number `time` among the metadata of the grid or of the file. Throws
/// IoError (not readable, damaged, or the program was built without OpenVDB: how to install it), InvalidInput
/// (no such grid or several, a transform that is no uniform scale and translation, no surface, a lattice of
/// more than 2^31 points).
ImageFrame read_vdb(const std::filesystem::path& file);

}  // namespace kappaflow
