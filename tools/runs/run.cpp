#include "tools/runs/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "core/errors.h"
#include "core/machine_memory.h"
#include "core/read_file.h"
#include "scenes/estimate.h"
#include "solver/broadcast_state.h"
#include "tools/runs/check.h"
#include "tools/runs/distant_liquid.h"
#include "tools/runs/progress.h"
#include "tools/runs/run_driver.h"
#include "tools/runs/run_record.h"
#include "tools/runs/scene_frames.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRunCommand = "run";

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

/// begun_with: what a checkpoint begins with, beside the hash of the scene.
RunSettings settings_for(const RunOptions& begun_with, const std::string& hash, const Scene& scene) {
  return {.command = kRunCommand,
          .title = scene.title,
          .output = scene.output,
          .methods = scene.surface.methods,
          .formats = begun_with.formats,
          .density_tolerance = scene.fluid.density_tolerance,
          .quiet = begun_with.quiet,
          .save_beginning = [begun_with, hash](StateWriter& archive) { archive(begun_with, hash); }};
}

/// Whether surfaces that are apart are told of the particles near them alone: where these are many, and
/// nothing asks for all of them.
bool near_alone(const SurfaceDescription& surface, const SceneEstimate& cost, const RunOptions& options) {
  const bool all = surface.kernels != Kernels::round || surface.weights != WeightRule::uniform ||
                   surface.anchor == Anchor::particles ||
                   std::ranges::count(surface.methods, "fresh-particles") > 0;
  return !all && cost.particles + cost.emitted > options.many;
}

/// surfaces: how many ranks follow them and have none of the liquid. For any number of threads the same.
LiquidPlace place_of_liquid(const Scene& scene, const SceneEstimate& cost, const RunOptions& options,
                            int surfaces) {
  const Ranks& all = *options.ranks;
  LiquidPlace place{.surface_ranks = surfaces, .tellers = 0};
  double here = 0;
  for (const int rank : all.on_this_machine()) {
    if (rank >= surfaces) here += all.share_of(rank, 1);
    if (rank < surfaces) ++place.surface_ranks_here;
    if (rank == 0 || rank == surfaces) ++place.tellers;
  }
  place.share = here / all.share_of(surfaces, all.size() - surfaces);
  place.is_near = surfaces > 0 && near_alone(scene.surface, cost, options);
  return place;
}

/// With as many ranks for the surfaces as is quickest, or fewer where this machine has too little memory for
/// that. Throws InvalidInput where it has too little for one.
LiquidPlace place_with_room(const PreparedScene& prepared, const RunOptions& options) {
  const Scene& scene = prepared.scene;
  const SceneEstimate cost = estimate(prepared, 1);
  LiquidPlace place;
  std::size_t needed = cost.memory_bytes;
  if (options.ranks != nullptr)
    for (int surfaces = options.surface_ranks.value_or(ranks_for_surfaces(cost, options.ranks->size()));;
         --surfaces) {
      place = place_of_liquid(scene, cost, options, surfaces);
      needed = memory_with_ranks(scene, cost, place);
      if (surfaces <= 1 || has_room(scene, needed, machine_memory())) break;
    }
  require_memory(scene, needed, machine_memory());
  return place;
}

/// folder: of the run.
std::unique_ptr<Liquid> liquid_of(PreparedScene& prepared, const LiquidPlace& place, Ranks* ranks,
                                  const fs::path& folder) {
  if (place.surface_ranks == 0) return own_liquid(prepared, ranks);
  prepared.start = {};
  return std::make_unique<DistantLiquid>(prepared, set_apart(*ranks, place.surface_ranks, place.is_near),
                                         fs::absolute(folder));
}

/// Makes the first mesh; until it is there nothing is to be saved, and a signal ends the program at once.
/// prepared: is to outlive it.
SceneFrames first_frame(PreparedScene& prepared, const LiquidPlace& place, const RunOptions& options,
                        const fs::path& folder) {
  StatusLine status(!options.quiet);
  status.show("making the first mesh");
  return {prepared, liquid_of(prepared, place, options.ranks, folder)};
}

/// On the ranks above the first one that have the surfaces.
void follow_surfaces(const PreparedScene& prepared, RanksApart ranks) {
  const std::shared_ptr<Ranks> part = ranks.part;
  try {
    SceneFrames(prepared, std::make_unique<DistantLiquid>(prepared, std::move(ranks))).follow();
  } catch (const Error&) {  // where the first one has come to the same, it says so, and ends this
    if (part->ended() || part->next_order().task != RankTask::end) throw;
  }
}

RunSummary begin(const RunOptions& options) {
  const Stopwatch watch;
  PreparedScene prepared = prepare(scene_for(options, load_scene(options.scene)));
  const Scene scene = prepared.scene;
  const std::string hash = prepared.hash;
  if (scene.surface.methods.empty())
    throw InvalidInput(
        fmt::format("{}: no velocity method to track with; name one in [surface] methods or by "
                    "--track, \"material\" where only the liquid matters",
                    scene.file.string()));
  const LiquidPlace place = place_with_room(prepared, options);
  RunOptions begun_with = options;
  begun_with.scene = fs::absolute(options.scene);  // for whoever resumes it from elsewhere
  RunFolder folder(folder_for(options), scene.surface.methods, options.force);
  folder.write_scene(scene.text);
  SceneFrames frames = first_frame(prepared, place, options, folder.path());
  const InterruptGuard guard;
  RunDriver driver(frames, folder, settings_for(begun_with, hash, scene), watch);
  folder.write_record(run_record(options, scene, frames));
  driver.start();
  return driver.advance(guard);
}

/// Makes a scene ready: prepare(), or prepare_without_particles().
using Prepare = PreparedScene (*)(Scene);

/// The scene in the run's folder, as long as it is the one that the run began with.
PreparedScene resumed_scene(const RunOptions& begun_with, const std::string& hash, const fs::path& folder,
                            const fs::path& named, Prepare make_ready) {
  const std::string text = read_file(folder / kSceneFile);
  PreparedScene prepared = make_ready(scene_for(begun_with, parse_scene(text, begun_with.scene)));
  if (prepared.hash != hash)
    throw InvalidInput({(folder / kSceneFile).string()},
                       "the scene, or a mesh that it names, has changed since the run began");
  if (!named.empty() && read_file(named) != text)
    throw InvalidInput({named.string()},
                       fmt::format("is not the scene that the run in {} began with", folder.string()));
  return prepared;
}

RunSummary resume(const RunOptions& options) {
  const Stopwatch watch;
  RunFolder folder(options.resume);
  std::optional<SavedRun> saved(std::in_place, folder.path(), kRunCommand);
  RunOptions begun_with;
  std::string hash;
  int frame = 0;
  saved->read(begun_with, hash, frame);
  begun_with.quiet = options.quiet;
  PreparedScene prepared = resumed_scene(begun_with, hash, folder.path(), options.scene, prepare);
  const Scene scene = prepared.scene;
  if (frame == last_frame_of(scene)) return complete_run(folder.path(), frame);

  const LiquidPlace place = place_with_room(prepared, options);
  if (options.ranks != nullptr) {  // what the run has saved the first rank alone reads
    options.ranks->announce({RankTask::resume});
    broadcast_state(*options.ranks, begun_with, hash);
    options.ranks->finish();
  }
  SceneFrames frames = first_frame(prepared, place, options, folder.path());
  const InterruptGuard guard;
  RunDriver driver(frames, folder, settings_for(begun_with, hash, scene), watch);
  driver.restore(frame, *saved);
  saved.reset();  // large
  folder.write_record(resumed_record(folder.path(), options.command, options.threads,
                                     ranks_of(options, frames), frames.time()));
  return driver.advance(guard);
}

}  // namespace

void follow_run(const RunOptions& options) {
  Ranks& ranks = *options.ranks;
  RunOptions begun_with = options;
  std::string hash;
  if (!options.resume.empty()) {
    if (ranks.next_order().task == RankTask::end) return;
    broadcast_state(ranks, begun_with, hash);
  }
  PreparedScene prepared =
      options.resume.empty()
          ? prepare_without_particles(scene_for(options, load_scene(options.scene)))
          : resumed_scene(begun_with, hash, options.resume, options.scene, prepare_without_particles);
  const RankOrder order = ranks.next_order();
  if (order.task == RankTask::make) make_fluid(prepared, &ranks).follow();
  if (order.task != RankTask::serve) return;
  RanksApart apart = set_apart(ranks);
  if (apart.has_surfaces()) {
    follow_surfaces(prepared, std::move(apart));
  } else {
    if (ranks.rank() == apart.surface_ranks)
      add_particles(prepared);  // the first of those that share the liquid
    serve_liquid(std::move(prepared), std::move(apart));
  }
  ranks.next_order();  // the end
}

RunSummary run_scene(const RunOptions& options) {
  return options.resume.empty() ? begin(options) : resume(options);
}

int run(const RunOptions& options) {
  const RunSummary summary = run_scene(options);
  const fs::path folder = options.resume.empty() ? folder_for(options) : options.resume;
  if (options.ranks != nullptr && !options.quiet) {
    const RankTraffic sent = options.ranks->traffic();
    fmt::print("{} ranks, of which the first has sent {} messages of {:.4g} MB together\n",
               options.ranks->size(), sent.messages, 1e-6 * static_cast<double>(sent.bytes));
  }
  return run_outcome(summary, kRunCommand, folder, options.quiet);
}

}  // namespace kappaflow
