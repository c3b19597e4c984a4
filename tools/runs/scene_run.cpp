#include "tools/runs/scene_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>
#include <vector>

#include "core/saved_state.h"
#include "tools/io/vtp_files.h"
#include "tools/runs/progress.h"

namespace kappaflow {
namespace {

std::string solver_iterations(const FluidStep& step) {
  return fmt::format("pressure {}, viscosity {}", step.density_iterations + step.divergence_iterations,
                     step.viscosity_iterations);
}

}  // namespace

FrameTimes::FrameTimes(const Scene& scene)
    : count(static_cast<int>(std::ceil(scene.duration * scene.output.frames_per_second - 1e-9))),
      frames_per_second(scene.output.frames_per_second),
      duration(scene.duration) {}

double FrameTimes::operator[](int frame) const {
  return std::min(frame / frames_per_second, duration);
}

SceneRun::SceneRun(const RunPoint& point, PreparedScene prepared, RunFolder& folder)
    : point_(point),
      scene_(prepared.scene),
      folder_(folder),
      times_(scene_),
      simulation_(std::move(prepared)),
      writer_(scene_, simulation_, point.options.formats, folder) {
  summary_.density_tolerance = scene_.fluid.density_tolerance;
}

void SceneRun::start() {
  summary_.setup_seconds = watch_.seconds();
  write_frame(0);
  write_checkpoint();
  folder_.take_place();
}

RunSummary SceneRun::advance(const InterruptGuard& guard) {
  try {
    advance_frames(guard);
  } catch (const SolverFailure& failure) {
    throw Error(fmt::format("{}; {}", failure.what(), written_particles()), failure.exit_code());
  } catch (const IoError& error) {
    throw Error(fmt::format("{}; with that mended, kappaflow run --resume {} goes on", error.what(),
                            folder_.path().string()),
                error.exit_code());
  } catch (const Error& error) {  // of a surface, which knows no time
    const FluidSolver& fluid = simulation_.fluid();
    throw Error(fmt::format("the surfaces failed at t = {:.6g} s, step {}: {}; {}", fluid.time(),
                            fluid.steps(), error.what(), written_particles()),
                error.exit_code());
  }
  summary_.steps = simulation_.fluid().steps();
  summary_.wall_seconds = watch_.seconds();
  summary_.interrupted_by = guard.signal();
  summary_.interrupted_at = simulation_.fluid().time();
  summary_.text =
      summary_text(summary_, scene_.title, simulation_.surfaces().field_options(), folder_.path());
  return std::move(summary_);
}

void SceneRun::advance_frames(const InterruptGuard& guard) {
  Progress progress(simulation_.fluid().time(), scene_.duration, times_.count, !point_.options.quiet);
  while (point_.frame < times_.count && !guard.interrupted()) {
    const int next = point_.frame + 1;
    const bool arrived = simulation_.advance(times_[next], [&](const FluidStep& step) {
      progress.show(simulation_.fluid().time(), next, solver_iterations(step));
      return !guard.interrupted();
    });
    if (arrived) write_frame(next);
    if (guard.interrupted() || point_.frame == times_.count ||
        point_.frame % scene_.output.checkpoint_interval == 0)
      write_checkpoint();
  }
}

void SceneRun::write_frame(int frame) {
  writer_.write(frame, times_[frame], simulation_.take_since_frame(), summary_);
  point_.frame = frame;
}

void SceneRun::write_checkpoint() {
  std::ostringstream state;
  StateWriter(state, little_endian())(point_, *this);
  folder_.write_checkpoint(state.view());
}

// What follows from the scene or stands in the tables is not in the checkpoint: it would grow with each
// frame.
void SceneRun::restore_frames() {
  std::vector<double> times;
  for (int frame = 0; frame <= point_.frame; ++frame) times.push_back(times_[frame]);
  folder_.set_times(std::move(times));
  summary_.add_frames_before(folder_.metrics());
  summary_.setup_seconds = watch_.seconds();
}

/// Writes the particles of a failed simulation, and says where they are.
std::string SceneRun::written_particles() const {
  const FluidSolver& fluid = simulation_.fluid();
  const std::filesystem::path file = folder_.path() / kFailureFile;
  try {
    write_vtp(file, *particle_data(
                        {fluid.particles(), fluid.densities(), fluid.pressures(), fluid.sources(), {}, 0}));
  } catch (const IoError& error) {
    return fmt::format("its particles are lost: {}", error.what());
  }
  return fmt::format("its particles are in {}", file.string());
}

}  // namespace kappaflow
