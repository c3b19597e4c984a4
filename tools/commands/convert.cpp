#include "tools/commands/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "tools/io/files.h"
#include "tools/io/folder_lock.h"
#include "tools/io/surface_file.h"
#include "tools/pictures/run_frames.h"
#include "tools/runs/frame_export.h"
#include "tools/runs/frame_rate.h"
#include "tools/runs/interrupt.h"
#include "tools/runs/progress.h"
#include "tools/runs/run_folder.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

/// Of frames that are there already.
std::vector<double> times_of(const RunFrames& run) {
  std::vector<double> times;
  WorkProgress progress("reading the time of frame", run.count());
  for (int frame = 0; frame < run.count(); ++frame) {
    progress.show(frame);
    times.push_back(time_of(*run.surface(run.methods().front(), frame)));
  }
  return times;
}

ExportSettings settings_for(const ConvertOptions& options, const RunFrames& run) {
  const ExportedSurface first = exported_surface(*run.surface(run.methods().front(), 0), {});
  ExportSettings settings{.formats = options.formats,
                          .methods = run.methods(),
                          .frames_per_second = real_time_rate(times_of(run)),
                          .up = options.up.value_or(run.view().up),
                          .texture = {bounding_box(first.rest), run.projection()},
                          .origin = far_origin(first.position),
                          .walls_at_start = run.walls(0),
                          .walls_move = run.walls_move(),
                          .has_particles = run.has_particles()};
  if (settings.formats.empty()) settings.formats = {MeshFormat::usd};
  return settings;
}

void convert_frame(const RunFrames& run, int frame, const FrameExport& files) {
  for (const std::string& method : run.methods())
    files.write_surface(frame, method, *run.surface(method, frame));
  if (run.has_particles()) files.write_particles(frame, *run.particle_data(frame));
  if (run.walls_move()) files.write_walls(frame, *run.walls(frame));
  files.finish_frame(frame);
}

/// Returns how many it came to.
int convert_frames(const RunFrames& run, const FrameExport& files, const InterruptGuard& guard) {
  WorkProgress progress("writing frame", run.count());
  int frame = 0;
  for (; frame < run.count() && !guard.interrupted(); ++frame) {
    progress.show(frame);
    convert_frame(run, frame, files);
  }
  return frame;
}

/// What to open, or where the meshes are.
std::string outcome(const fs::path& out, const ExportSettings& settings, int frames) {
  std::string text = fmt::format("{}: {} frames\n", out.string(), frames);
  for (const MeshFormat format : settings.formats)
    for (const std::string& method : settings.methods) {
      const fs::path first = out / surface_file(method, 0);
      text += format == MeshFormat::usd
                  ? fmt::format("  {}\n", (out / fmt::format("surface-{}.usda", method)).string())
                  : fmt::format("  {} ...\n",
                                fs::path(first).replace_extension(name_of(kMeshFormats, format)).string());
    }
  if (std::ranges::count(settings.formats, MeshFormat::usd) > 0)
    text += fmt::format("  {} ({})\n", (out / "run.usda").string(),
                        settings.has_particles ? "with particles and walls" : "all of them");
  return text;
}

}  // namespace

int convert(const ConvertOptions& options) {
  const InterruptGuard guard;
  const RunFrames run(options.folder, options.methods);
  const fs::path out = options.out.empty() ? options.folder : options.out;
  make_folder(out);
  const FolderLock lock(out);
  const ExportSettings settings = settings_for(options, run);
  const FrameExport files(settings, [&](const std::string& name, const std::string& content) {
    make_folder((out / name).parent_path());
    write_file(out / name, content);
  });
  const int frames = convert_frames(run, files, guard);
  fmt::print("{}", outcome(out, settings, frames));
  if (frames == run.count()) return 0;
  fmt::print(stderr, "kappaflow: interrupted; {} of {} frames are complete\n", frames, run.count());
  return exit_code_after(guard.signal());
}

}  // namespace kappaflow
