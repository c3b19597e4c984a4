#include "tools/run_folder.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/errors.h"
#include "tools/data_files.h"
#include "tools/files.h"
#include "tools/metrics.h"
#include "tools/pvd.h"
#include "tools/timings.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMetricsFile = "metrics.csv";
constexpr const char* kPiecesFile = "pieces.csv";
constexpr const char* kTimingsFile = "timings.csv";

bool is_surface_name(const std::string& name) {
  return name.starts_with("surface-");
}

bool is_data_folder(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  return entry.is_directory() && (name == "particles" || name == "boundary" || is_surface_name(name));
}

bool is_run_file(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  if (name == kRecordFile || name == kMetricsFile || name == kPiecesFile || name == kTimingsFile ||
      name == kBoundaryFile)
    return true;
  return entry.path().extension() == ".pvd" &&
         (name == "run.pvd" || name == "particles.pvd" || name == "boundary.pvd" || is_surface_name(name));
}

bool is_data_file(const fs::directory_entry& entry) {
  const std::string kind = entry.path().extension().string();
  return kind == ".vtp" || kind == ".tmp" || std::ranges::any_of(kMeshFormats, [&](const auto& format) {
           return kind == fmt::format(".{}", format.name);
         });
}

// A copy, since removing entries while iterating over them is undefined.
std::vector<fs::directory_entry> entries_of(const fs::path& folder) {
  return {fs::directory_iterator(folder), fs::directory_iterator()};
}

// Only what a run wrote: pictures and notes that the user put beside it stay.
void remove_run(const fs::path& folder) {
  for (const auto& entry : entries_of(folder)) {
    if (is_run_file(entry)) fs::remove(entry);
    if (!is_data_folder(entry)) continue;
    for (const auto& file : entries_of(entry))
      if (is_data_file(file)) fs::remove(file);
    if (fs::is_empty(entry)) fs::remove(entry);
  }
}

void make_room(const fs::path& folder, bool force) {
  try {
    if (!fs::exists(folder / kRecordFile)) return;
    if (!force)
      throw InvalidInput(fmt::format(
          "{} already holds a run; --force replaces it, --out DIR writes elsewhere", folder.string()));
    remove_run(folder);
  } catch (const fs::filesystem_error& error) {
    throw IoError(folder.string(), error.code().message());
  }
}

fs::path made_folder(fs::path folder) {
  make_folder(folder);
  return folder;
}

}  // namespace

std::string particle_file(int frame) {
  return fmt::format("particles/particles_{:04}.vtp", frame);
}

std::string surface_file(const std::string& method, int frame) {
  return fmt::format("surface-{}/surface_{:04}.vtp", method, frame);
}

std::string boundary_file(int frame) {
  return fmt::format("boundary/boundary_{:04}.vtp", frame);
}

RunFolder::RunFolder(fs::path folder, std::vector<std::string> methods, bool force)
    : folder_(made_folder(std::move(folder))), lock_(folder_), methods_(std::move(methods)) {
  make_room(folder_, force);
  make_folder(folder_ / "particles");
  for (const std::string& method : methods_) make_folder(folder_ / ("surface-" + method));
  write_file(folder_ / kMetricsFile, metrics_header());
  write_file(folder_ / kPiecesFile, pieces_header());
  write_file(folder_ / kTimingsFile, timings_header());
}

void RunFolder::write_record(const std::string& json) {
  write_file(folder_ / kRecordFile, json);
}

void RunFolder::write_boundary(vtkPolyData& data) {
  write_vtp(folder_ / kBoundaryFile, data);
  has_boundary_ = true;
}

void RunFolder::write_boundary(int frame, vtkPolyData& data) {
  if (!boundary_moves_) make_folder(folder_ / "boundary");
  has_boundary_ = boundary_moves_ = true;
  write_vtp(folder_ / boundary_file(frame), data);
}

void RunFolder::write_particles(int frame, vtkPolyData& data) {
  write_vtp(folder_ / particle_file(frame), data);
}

void RunFolder::write_surface(int frame, const std::string& method, vtkPolyData& data) {
  write_vtp(folder_ / surface_file(method, frame), data);
}

void RunFolder::write_mesh(int frame, const std::string& method, MeshFormat format,
                           const std::string& bytes) {
  fs::path file = folder_ / surface_file(method, frame);
  write_file(file.replace_extension(name_of(kMeshFormats, format)), bytes);
}

void RunFolder::finish_frame(double time, const FrameRows& rows) {
  times_.push_back(time);
  write_collections();
  append_lines(folder_ / kMetricsFile, rows.metrics);
  append_lines(folder_ / kPiecesFile, rows.pieces);
  append_lines(folder_ / kTimingsFile, rows.timings);
}

void RunFolder::write_collections() const {
  // A collection for all parts, and one for each of them.
  std::vector<PvdEntry> all;
  std::vector<std::vector<PvdEntry>> series(1 + methods_.size() + (boundary_moves_ ? 1 : 0));
  for (std::size_t frame = 0; frame < times_.size(); ++frame) {
    const int number = static_cast<int>(frame);
    int part = 0;
    const auto add = [&](const std::string& name, const std::string& file) {
      all.push_back({times_[frame], part, name, file});
      if (file != kBoundaryFile) series[part].push_back({times_[frame], 0, name, file});
      ++part;
    };
    add("particles", particle_file(number));
    for (const std::string& method : methods_) add("surface-" + method, surface_file(method, number));
    if (has_boundary_) add("boundary", boundary_moves_ ? boundary_file(number) : kBoundaryFile);
  }
  for (std::size_t s = 0; s < series.size(); ++s)
    write_file(folder_ / (series[s].front().name + ".pvd"), pvd_text(series[s]));
  write_file(folder_ / "run.pvd", pvd_text(all));
}

}  // namespace kappaflow
