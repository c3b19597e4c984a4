#include "tools/runs/frame_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "tools/io/usd_file.h"
#include "tools/runs/run_folder.h"

namespace kappaflow {
namespace {

constexpr const char* kWallMeshes = "boundary/walls.usda";

bool points_along_z(const Vec3& up) {
  Eigen::Index axis = 0;
  up.cwiseAbs().maxCoeff(&axis);
  return axis == 2;
}

/// A series of files, of whose names value clips want the number between dots.
UsdPrim series(const std::string& name, const std::string& file, int frames) {
  return {name, fmt::format("{}/{}", name, file), name + "/manifest.usda", frames};
}

UsdPrim surface_series(const std::string& method, int frames) {
  return series("surface-" + method, "surface", frames);
}
UsdPrim particle_series(int frames) {
  return series("particles", "particles", frames);
}
UsdPrim wall_series(int frames) {
  return series("boundary", "boundary", frames);
}

std::string clip_file(const UsdPrim& prim, int frame) {
  return fmt::format("{}.{:04}.usda", prim.stem, frame);
}

}  // namespace

FrameExport::FrameExport(ExportSettings settings, Write write)
    : settings_(std::move(settings)), write_(std::move(write)) {
  stage_ = {settings_.frames_per_second, points_along_z(settings_.up), settings_.origin};
  if (settings_.walls_at_start) walls_ = usd_walls(exported_walls(*settings_.walls_at_start));
}

bool FrameExport::has_usd() const {
  return std::ranges::count(settings_.formats, MeshFormat::usd) > 0;
}

void FrameExport::write_surface(int frame, const std::string& method, vtkPolyData& surface) const {
  const ExportedSurface exported = exported_surface(surface, settings_.texture);
  const TexturedMesh mesh = exported.mesh(stage_.z_up);
  for (const MeshFormat format : settings_.formats) {
    if (format == MeshFormat::usd) {
      write_(clip_file(surface_series(method, frame + 1), frame),
             usd_surface_frame(frame, mesh, stage_.origin));
      continue;
    }
    std::filesystem::path name = surface_file(method, frame);
    write_(name.replace_extension(name_of(kMeshFormats, format)).string(), mesh_bytes(format, mesh));
  }
}

void FrameExport::write_particles(int frame, vtkPolyData& particles) const {
  if (!has_usd()) return;
  write_(clip_file(particle_series(frame + 1), frame),
         usd_particles_frame(frame, exported_points(particles), stage_.origin));
}

void FrameExport::write_walls(int frame, vtkPolyData& walls) const {
  if (!has_usd()) return;
  write_(clip_file(wall_series(frame + 1), frame),
         usd_walls_frame(frame, walls_, exported_walls(walls), stage_.origin));
}

void FrameExport::finish_frame(int frame) const {
  if (!has_usd()) return;
  if (frame == 0) write_common_files();
  write_roots(frame + 1);
}

/// That all frames share.
void FrameExport::write_common_files() const {
  for (const std::string& method : settings_.methods)
    write_(surface_series(method, 1).manifest, usd_surface_manifest());
  if (settings_.has_particles) write_(particle_series(1).manifest, usd_particles_manifest());
  if (walls_.empty()) return;
  write_(kWallMeshes, usd_wall_meshes(stage_, walls_, settings_.walls_move));
  if (settings_.walls_move) write_(wall_series(1).manifest, usd_walls_manifest(walls_.size()));
}

void FrameExport::write_roots(int frames) const {
  std::vector<std::string> roots;
  const auto add = [&](const UsdPrim& prim, const std::string& root) {
    roots.push_back(prim.name + ".usda");
    write_(roots.back(), root);
  };
  for (const std::string& method : settings_.methods) {
    const UsdPrim surface = surface_series(method, frames);
    add(surface, usd_surface_root(stage_, surface));
  }
  if (settings_.has_particles)
    add(particle_series(frames), usd_particles_root(stage_, particle_series(frames)));
  if (!walls_.empty())
    add(wall_series(frames), usd_walls_root(stage_, wall_series(frames), kWallMeshes, settings_.walls_move));
  write_("run.usda", usd_header(stage_, frames, roots) + usd_world(stage_, ""));
}

}  // namespace kappaflow
