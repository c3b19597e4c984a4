#include "tools/runs/track.h"

#include <fmt/format.h>

#include <cstdio>
#include <utility>

#include "core/errors.h"
#include "tools/io/input_kind.h"
#include "tools/runs/progress.h"
#include "tools/runs/run_driver.h"
#include "tools/runs/run_record.h"
#include "tools/runs/track_input.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTrackCommand = "track";
constexpr double kEdgeLength = 0.25;  // of sigma: half a particle spacing, or that of a grid

fs::path folder_for(const TrackOptions& options, const TrackInput& input) {
  return options.folder.empty() ? fs::path("out") / input.name() : options.folder;
}

std::string pieces_text(const FileSeries& series) {
  if (series.pieces.empty()) return {};
  return fmt::format(", each with the others of its {} pieces", series.pieces.front().size());
}

std::string setup_text(const TrackInput& input) {
  const std::vector<fs::path>& files = input.series().files;
  std::string text = fmt::format("{}: {} files, {} ... {}{}\n", input.name(), files.size(),
                                 files.front().string(), files.back().string(), pieces_text(input.series()));
  for (const std::string& note : input.notes()) text += fmt::format("  {}\n", note);
  return text + input.setup_text() + fmt::format("  velocity {}\n", fmt::join(input.surface().methods, ", "));
}

/// The files where anybody finds them, as a checkpoint has them.
FileSeries absolute(FileSeries series) {
  for (fs::path& file : series.files) file = fs::absolute(file);
  for (std::vector<fs::path>& pieces : series.pieces)
    for (fs::path& file : pieces) file = fs::absolute(file);
  return series;
}

RunSettings settings_for(const TrackOptions& options, const TrackInput& input) {
  OutputDescription output;
  if (options.checker_edge) output.checker_size = *options.checker_edge / input.length_scale();
  output.texture = options.texture;
  output.metrics_interval = options.metrics_interval;
  output.rest_interval = options.rest_interval;
  return {.command = kTrackCommand,
          .title = input.name(),
          .output = output,
          .methods = input.surface().methods,
          .formats = options.formats,
          .quiet = options.quiet,
          .save_beginning = [options, series = absolute(input.series()),
                             hash = input.hash()](StateWriter& archive) { archive(options, series, hash); }};
}

/// Reads and checks all files, and says so from the first second on.
std::unique_ptr<TrackInput> read_input(const FileSeries& series, const TrackOptions& options) {
  WorkProgress progress("checking file", static_cast<int>(series.files.size()), !options.quiet);
  return open_input(series, options, [&](std::size_t file) { progress.show(static_cast<int>(file)); });
}

std::unique_ptr<FrameSource> first_frame(TrackInput& input, const TrackOptions& options) {
  StatusLine status(!options.quiet);
  status.show("making the first mesh");
  return input.frames(options.metrics_interval > 0);
}

// Until there is something to save a signal ends the program at once.
RunSummary begin(const TrackOptions& options, TrackInput& input, const Stopwatch& watch) {
  input.check_motion();
  const std::unique_ptr<FrameSource> frames = first_frame(input, options);
  const InterruptGuard guard;
  RunFolder folder(folder_for(options, input), input.surface().methods, options.force);
  folder.write_record(track_record(options, input));
  if (!options.quiet) fmt::print("{}{}", setup_text(input), input.warning(*frames));
  std::fflush(stdout);
  RunDriver driver(*frames, folder, settings_for(options, input), watch);
  driver.start();
  return driver.advance(guard);
}

RunSummary resume(const TrackOptions& options) {
  const InterruptGuard guard;
  const Stopwatch watch;
  RunFolder folder(options.resume);
  SavedRun saved(folder.path(), kTrackCommand);
  TrackOptions begun;
  FileSeries series;
  std::string hash;
  int frame = 0;
  saved.read(begun, series, hash, frame);
  begun.quiet = options.quiet;
  if (frame + 1 == std::ssize(series.files)) return complete_run(folder.path(), frame);

  if (!options.inputs.empty()) series = file_series(options.inputs, begun.range);
  const std::unique_ptr<TrackInput> input = read_input(series, begun);
  if (input->hash() != hash)
    throw InvalidInput(fmt::format("{}: the files are not those that the run in {} began with", input->name(),
                                   folder.path().string()));
  const std::unique_ptr<FrameSource> frames = first_frame(*input, begun);
  RunDriver driver(*frames, folder, settings_for(begun, *input), watch);
  driver.restore(frame, saved);
  folder.write_record(resumed_record(folder.path(), options.command, options.threads, {}, frames->time()));
  return driver.advance(guard);
}

}  // namespace

double edge_length_in(double length_scale, const TrackOptions& options) {
  const double edge = options.edge_length ? *options.edge_length / length_scale : kEdgeLength;
  if (edge < kFinestEdge || edge > kCoarsestEdge)
    throw InvalidInput(fmt::format(
        "--edge: found {:.4g} m; expected {:.4g} to {:.4g} m, which is {} to {} sigma", *options.edge_length,
        kFinestEdge * length_scale, kCoarsestEdge * length_scale, kFinestEdge, kCoarsestEdge));
  return edge;
}

std::unique_ptr<TrackInput> open_input(const FileSeries& series, const TrackOptions& options,
                                       const FileWatch& watch) {
  const InputKind kind = input_kind(series.files_of(0));
  return kind == InputKind::particles ? particle_input(series, options, watch)
                                      : distance_input(series, kind, options, watch);
}

int track(const TrackOptions& options) {
  if (!options.resume.empty())
    return run_outcome(resume(options), kTrackCommand, options.resume, options.quiet);
  const Stopwatch watch;
  const std::unique_ptr<TrackInput> input = read_input(file_series(options.inputs, options.range), options);
  return run_outcome(begin(options, *input, watch), kTrackCommand, folder_for(options, *input),
                     options.quiet);
}

}  // namespace kappaflow
