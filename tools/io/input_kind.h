// What a file that another program wrote holds.
#pragma once

#include <filesystem>
#include <span>

#include "core/named.h"

namespace kappaflow {

enum class InputKind { particles, images, meshes };

/// As messages have them.
inline constexpr Named<InputKind> kInputKinds[] = {
    {"particles", InputKind::particles}, {"images", InputKind::images}, {"meshes", InputKind::meshes}};

/// By the ending of the name: particles .vtu, .pvtu, .pvtp, .bgeo, .hdf5 and .csv; images .vti, .pvti and
/// .vdb; meshes .obj, .ply and .stl. By what is in it, .vtk: images where it holds structured points, meshes
/// where it holds polygons or triangle strips, else particles; .vtp: meshes where a piece that begins in the
/// first MiB has polygons or strips, else particles. Throws IoError where it must be read and cannot be,
/// InvalidInput for other endings.
InputKind input_kind(const std::filesystem::path& file);

/// Of a frame that lies in these files. Throws IoError where one of them must be read and cannot be,
/// InvalidInput where its pieces are of several kinds, or of one that is read from one file a frame: meshes
/// and .vdb.
InputKind input_kind(std::span<const std::filesystem::path> files);

/// Whether the ending of the name is one of those.
bool is_input_file(const std::filesystem::path& file);
inline constexpr const char* kInputFileKinds =
    ".vtk, .vtp, .vtu, .pvtp, .pvtu, .bgeo, .hdf5 or .csv with particles, .vti, .pvti, .vtk or .vdb with "
    "distances, .obj, .ply, .stl, .vtp or .vtk with meshes";

}  // namespace kappaflow
