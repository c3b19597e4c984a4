#include "tools/runs/run.h"

#include <fmt/format.h>

#include <cereal/cereal.hpp>
#include <optional>
#include <sstream>
#include <utility>

#include "core/errors.h"
#include "core/read_file.h"
#include "core/saved_state.h"
#include "tools/io/checkpoint.h"
#include "tools/runs/check.h"
#include "tools/runs/run_record.h"
#include "tools/runs/scene_run.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

/// The scene of a text that was read from options.scene, as the options want it.
Scene scene_for(const RunOptions& options, Scene scene) {
  if (options.duration) scene.duration = *options.duration;
  if (options.keep_connectivity) scene.surface.remesh = false;
  if (!options.methods.empty()) scene.surface.methods = options.methods;
  return scene;
}

fs::path folder_for(const RunOptions& options) {
  return options.folder.empty() ? fs::path("out") / options.scene.stem() : options.folder;
}

RunSummary begin(const RunOptions& options, const InterruptGuard& guard) {
  PreparedScene prepared = prepare(scene_for(options, load_scene(options.scene)));
  const Scene& scene = prepared.scene;
  if (scene.surface.methods.empty())
    throw InvalidInput(
        fmt::format("{}: no velocity method to track with; name one in [surface] methods or by "
                    "--track, \"material\" where only the liquid matters",
                    scene.file.string()));
  require_memory(prepared, machine_memory());
  RunPoint point{options, prepared.hash};
  point.options.scene = fs::absolute(options.scene);  // for whoever resumes it from elsewhere
  RunFolder folder(folder_for(options), scene.surface.methods, options.force);
  folder.write_scene(scene.text);
  SceneRun run(point, std::move(prepared), folder);
  folder.write_record(run_record(options, run.scene(), run.simulation()));
  run.start();
  return run.advance(guard);
}

/// The scene in the run's folder, as long as it is the one that the run began with.
PreparedScene resumed_scene(const RunPoint& point, const fs::path& folder, const fs::path& named) {
  const std::string text = read_file(folder / kSceneFile);
  PreparedScene prepared = prepare(scene_for(point.options, parse_scene(text, point.options.scene)));
  if (prepared.hash != point.scene_hash)
    throw InvalidInput({(folder / kSceneFile).string()},
                       "the scene, or a mesh that it names, has changed since the run began");
  if (!named.empty() && read_file(named) != text)
    throw InvalidInput({named.string()},
                       fmt::format("is not the scene that the run in {} began with", folder.string()));
  return prepared;
}

/// Reads the rest of the checkpoint into the run.
void restore(StateReader& archive, std::istream& bytes, const fs::path& file, SceneRun& run) {
  try {
    archive(run);
  } catch (const cereal::Exception&) {
    bytes.setstate(std::ios::failbit);
  }
  if (!bytes || bytes.peek() != std::istream::traits_type::eof())
    throw IoError(file.string(), "does not hold what this version of kappaflow saves");
}

RunSummary resume(const RunOptions& options, const InterruptGuard& guard) {
  RunFolder folder(options.resume);
  const fs::path file = folder.path() / kCheckpointFile;
  if (!fs::exists(file))
    throw IoError(folder.path().string(),
                  "holds no checkpoint to go on from; a run that ended before its first frame is begun anew");
  std::istringstream bytes(read_checkpoint(file));
  StateReader archive(bytes);
  RunPoint point;
  archive(point);
  point.options.quiet = options.quiet;
  PreparedScene prepared = resumed_scene(point, folder.path(), options.scene);
  RunSummary complete;
  complete.text =
      fmt::format("{}: the run is complete, {} frames\n", folder.path().string(), point.frame + 1);
  if (point.frame == FrameTimes(prepared.scene).count) return complete;

  require_memory(prepared, machine_memory());
  SceneRun run(point, std::move(prepared), folder);
  restore(archive, bytes, file, run);
  const fs::path record = folder.path() / kRecordFile;
  folder.write_record(resumed_record(read_file(record), options, run.simulation().fluid().time()));
  return run.advance(guard);
}

}  // namespace

RunSummary run_scene(const RunOptions& options) {
  const InterruptGuard guard;
  return options.resume.empty() ? begin(options, guard) : resume(options, guard);
}

int run(const RunOptions& options) {
  const RunSummary summary = run_scene(options);
  if (!options.quiet) fmt::print("{}", summary.text);
  if (summary.interrupted_by == 0) return 0;
  const fs::path folder = options.resume.empty() ? folder_for(options) : options.resume;
  fmt::print(stderr,
             "kappaflow: interrupted at t = {:.6g} s; {} frames are complete; kappaflow run --resume {} goes "
             "on\n",
             summary.interrupted_at, summary.frames.size(), folder.string());
  return exit_code_after(summary.interrupted_by);
}

}  // namespace kappaflow
