#include "tools/runs/run_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "core/errors.h"
#include "tools/io/checkpoint.h"
#include "tools/io/files.h"
#include "tools/io/mesh_formats.h"
#include "tools/io/pvd.h"
#include "tools/io/vtp_files.h"
#include "tools/runs/body_rows.h"
#include "tools/runs/timings.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPiecesFile = "pieces.csv";
constexpr const char* kBodiesFile = "bodies.csv";
constexpr const char* kBeginningFolder = "beginning.tmp";  // of a run that is to replace another
constexpr std::array kTables{kMetricsFile, kPiecesFile, kTimingsFile, kBodiesFile};
constexpr std::size_t kTablesOfAll = 3;  // runs; the other has a header with its first rows
constexpr std::array kOtherFiles{kRecordFile, kSceneFile, kCheckpointFile, kBoundaryFile, kFailureFile};

bool is_surface_name(const std::string& name) {
  return name.starts_with("surface-");
}

bool is_data_name(const std::string& name) {
  return name == "particles" || name == "boundary" || is_surface_name(name);
}

bool is_data_folder(const fs::directory_entry& entry) {
  return entry.is_directory() && is_data_name(entry.path().filename().string());
}

bool is_run_file(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  if (std::ranges::count(kTables, name) > 0 || std::ranges::count(kOtherFiles, name) > 0) return true;
  const fs::path kind = entry.path().extension();
  const std::string stem = entry.path().stem().string();
  return (kind == ".pvd" || kind == ".usda") && (stem == "run" || is_data_name(stem));
}

bool is_data_file(const fs::directory_entry& entry) {
  const std::string kind = entry.path().extension().string();
  return kind == ".vtp" || kind == ".pvtp" || kind == ".tmp" || kind == ".usda" ||
         std::ranges::any_of(kMeshFormats,
                             [&](const auto& format) { return kind == fmt::format(".{}", format.name); });
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

/// A run, or frames that lie where a run's would, whoever wrote them. What is left of a run that ended before
/// its first frame does not count.
bool holds_results(const fs::path& folder) {
  return fs::exists(folder / kRecordFile) ||
         std::ranges::any_of(entries_of(folder), [](const fs::directory_entry& entry) {
           return is_data_folder(entry) && std::ranges::any_of(entries_of(entry), is_data_file);
         });
}

fs::path made_folder(fs::path folder) {
  make_folder(folder);
  return folder;
}

/// Of a run that was ended before it could take its place.
void remove_beginning(const fs::path& folder) {
  std::error_code ignored;  // what is left of it is in no run's way
  fs::remove_all(folder / kBeginningFolder, ignored);
}

/// Where a new run writes its first frame.
fs::path place_to_begin(const fs::path& folder, bool force) {
  remove_beginning(folder);
  try {
    if (!holds_results(folder)) return folder;
  } catch (const fs::filesystem_error& error) {
    throw IoError(folder.string(), error.code().message());
  }
  if (!force)
    throw InvalidInput(fmt::format(
        "{} already holds a run; {}--force replaces it, --out DIR writes elsewhere", folder.string(),
        !fs::exists(folder / kCheckpointFile) ? ""
        : fs::exists(folder / kSceneFile)     ? "kappaflow run --resume goes on with it, "
                                              : "kappaflow track --resume goes on with it, "));
  return made_folder(folder / kBeginningFolder);
}

/// Into folders of the same names where these are there.
void move_files(const fs::path& from, const fs::path& to) {
  for (const auto& entry : entries_of(from)) {
    const fs::path target = to / entry.path().filename();
    if (entry.is_directory() && fs::is_directory(target))
      move_files(entry, target);
    else
      fs::rename(entry, target);
  }
  fs::remove(from);
}

}  // namespace

bool is_run_folder(const fs::path& folder) {
  return is_data_name(folder.filename().string()) && fs::exists(folder.parent_path() / kRecordFile);
}

std::string particle_file(int frame) {
  return fmt::format("particles/particles_{:04}.vtp", frame);
}

std::string particle_list(int frame) {
  return fmt::format("particles/particles_{:04}.pvtp", frame);
}

std::string particle_piece(int frame, int rank) {
  return fmt::format("particles/particles_{:04}_{}.vtp", frame, rank);
}

fs::path particles_of(const fs::path& run, int frame) {
  const fs::path list = run / particle_list(frame);
  return fs::exists(list) ? list : run / particle_file(frame);
}

std::string surface_file(const std::string& method, int frame) {
  return fmt::format("surface-{}/surface_{:04}.vtp", method, frame);
}

std::string boundary_file(int frame) {
  return fmt::format("boundary/boundary_{:04}.vtp", frame);
}

RunFolder::RunFolder(fs::path folder, std::vector<std::string> methods, bool force)
    : folder_(made_folder(std::move(folder))),
      lock_(folder_),
      place_(place_to_begin(folder_, force)),
      methods_(std::move(methods)) {
  for (const std::string& method : methods_) make_folder(place_ / ("surface-" + method));
  const std::array headers{metrics_header(), pieces_header(), timings_header()};
  for (std::size_t t = 0; t < kTablesOfAll; ++t) {
    write_now(place_ / kTables[t], headers[t]);
    table_lines_[t] = 1;
  }
}

RunFolder::RunFolder(fs::path folder) : folder_(std::move(folder)), lock_(folder_), place_(folder_) {
  remove_beginning(folder_);
}

RunFolder::~RunFolder() {
  start_work();
  if (last_work_.valid()) last_work_.wait();
  if (place_ != folder_) remove_beginning(folder_);
}

void RunFolder::take_place() {
  wait();
  if (place_ == folder_) return;
  flush();
  const fs::path begun = std::exchange(place_, folder_);
  try {
    remove_run(folder_);
    move_files(begun, folder_);
  } catch (const fs::filesystem_error& error) {
    throw IoError(folder_.string(), error.code().message());
  }
  flush_to_disk(folder_);
}

void RunFolder::beside(std::function<void()> work) {
  work_.push_back(std::move(work));
}

void RunFolder::start_work() {
  if (work_.empty()) return;
  auto in_turn = [before = last_work_, works = std::exchange(work_, {})]() mutable {
    if (before.valid()) before.get();
    before = {};
    for (const std::function<void()>& work : works) work();
    works.clear();  // and lets go of their data
  };
  last_work_ = std::async(std::launch::async, std::move(in_turn)).share();
}

void RunFolder::wait() {
  start_work();
  if (last_work_.valid()) last_work_.get();
}

void RunFolder::write_data(const std::string& name, vtkSmartPointer<vtkPolyData> data) {
  beside([this, file = place_ / name, data = std::move(data)] {
    write_vtp(file, *data);
    written_.insert(file);
  });
}

void RunFolder::write_text(const std::string& name, std::string text) {
  beside([this, file = place_ / name, text = std::move(text)] { write_now(file, text); });
}

void RunFolder::write_now(const fs::path& file, const std::string& text) {
  write_file(file, text);
  written_.insert(file);
}

void RunFolder::write_record(const std::string& json) {
  write_text(kRecordFile, json);
}

void RunFolder::write_scene(const std::string& text) {
  write_text(kSceneFile, text);
}

void RunFolder::write_boundary(vtkSmartPointer<vtkPolyData> data) {
  write_data(kBoundaryFile, std::move(data));
  has_boundary_ = true;
}

void RunFolder::write_boundary(int frame, vtkSmartPointer<vtkPolyData> data) {
  if (!boundary_moves_) make_folder(place_ / "boundary");
  has_boundary_ = boundary_moves_ = true;
  write_data(boundary_file(frame), std::move(data));
}

void RunFolder::write_particles(int frame, vtkSmartPointer<vtkPolyData> data) {
  if (!std::exchange(has_particles_, true)) make_folder(place_ / "particles");
  if (!in_pieces_.empty()) list_pieces(frame, {particle_file(frame)}, *data);
  write_data(particle_file(frame), std::move(data));
}

void RunFolder::list_particles(int frame, int ranks, int count, vtkPolyData& like) {
  has_particles_ = true;
  std::vector<std::string> pieces;
  for (int rank = 0; rank < ranks; ++rank)
    if (fs::exists(place_ / particle_piece(frame, rank))) pieces.push_back(particle_piece(frame, rank));
  if (std::ssize(pieces) != count)
    throw IoError(
        (place_ / particle_list(frame)).string(),
        fmt::format("ranks have written {} pieces of it, of which {} can be seen from the first one: "
                    "all need the same folder",
                    count, pieces.size()));
  list_pieces(frame, pieces, like);
  for (int rank = ranks; fs::exists(place_ / particle_piece(frame, rank)); ++rank)  // of a run of more ranks
    beside([file = place_ / particle_piece(frame, rank)] { remove_file(file); });
}

/// Who finds the list of one frame in the folder expects those of all: those before it come first.
void RunFolder::list_pieces(int frame, std::vector<std::string> pieces, vtkPolyData& like) {
  for (int before = 0; before < frame; ++before)
    if (!in_pieces_.contains(before)) list_pieces(before, {particle_file(before)}, like);
  for (std::string& piece : pieces) piece = fs::path(piece).filename().string();
  write_text(particle_list(frame), pvtp_text(like, pieces));
  in_pieces_.insert(frame);
}

void RunFolder::write_surface(int frame, const std::string& method, vtkSmartPointer<vtkPolyData> data) {
  write_data(surface_file(method, frame), std::move(data));
}

void RunFolder::write_export(const std::string& name, const std::string& content) {
  make_folder((place_ / name).parent_path());
  write_now(place_ / name, content);
}

void RunFolder::finish_frame(double time, const FrameRows& rows) {
  times_.push_back(time);
  write_collections();
  const std::array lines{rows.metrics, rows.pieces, rows.timings, rows.bodies};
  for (std::size_t t = 0; t < kTables.size(); ++t) {
    if (lines[t].empty()) continue;
    if (table_lines_[t] == 0) {
      beside([this, file = place_ / kTables[t]] { write_now(file, bodies_header()); });
      table_lines_[t] = 1;
    }
    table_lines_[t] += std::ranges::count(lines[t], '\n');
    beside([this, file = place_ / kTables[t], rows = lines[t]] {
      append_lines(file, rows);
      written_.insert(file);
    });
  }
  start_work();
}

void RunFolder::flush() {
  std::set<fs::path> folders;
  for (const fs::path& file : written_) {
    flush_to_disk(file);
    folders.insert(file.parent_path());
  }
  for (const fs::path& folder : folders) flush_to_disk(folder);
  written_.clear();
}

void RunFolder::write_checkpoint(std::string state) {
  beside([this, file = place_ / kCheckpointFile, state = std::move(state)] {
    flush();
    kappaflow::write_checkpoint(file, state);
  });
  start_work();
}

void RunFolder::set_times(std::vector<double> times) {
  times_ = std::move(times);
  for (int frame = 0; frame < std::ssize(times_); ++frame)
    if (fs::exists(folder_ / particle_list(frame))) in_pieces_.insert(frame);
}

std::vector<MetricsRow> RunFolder::metrics() const {
  return read_metrics(folder_ / kMetricsFile);
}

void RunFolder::cut_tables() const {
  for (std::size_t t = 0; t < kTables.size(); ++t)
    if (table_lines_[t] > 0) cut_to_lines(folder_ / kTables[t], table_lines_[t]);
}

void RunFolder::write_collections() {
  // A collection for all parts, and one for each of them.
  std::vector<PvdEntry> all;
  std::vector<std::vector<PvdEntry>> series((has_particles_ ? 1 : 0) + methods_.size() +
                                            (boundary_moves_ ? 1 : 0));
  for (std::size_t frame = 0; frame < times_.size(); ++frame) {
    const int number = static_cast<int>(frame);
    int part = 0;
    const auto add = [&](const std::string& name, const std::string& file) {
      all.push_back({times_[frame], part, name, file});
      if (file != kBoundaryFile) series[part].push_back({times_[frame], 0, name, file});
      ++part;
    };
    if (has_particles_)
      add("particles", in_pieces_.contains(number) ? particle_list(number) : particle_file(number));
    for (const std::string& method : methods_) add("surface-" + method, surface_file(method, number));
    if (has_boundary_) add("boundary", boundary_moves_ ? boundary_file(number) : kBoundaryFile);
  }
  for (std::size_t s = 0; s < series.size(); ++s)
    write_text(series[s].front().name + ".pvd", pvd_text(series[s]));
  write_text("run.pvd", pvd_text(all));
}

}  // namespace kappaflow
