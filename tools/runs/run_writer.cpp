#include "tools/runs/run_writer.h"

#include <algorithm>

#include "tools/io/vtp_files.h"
#include "tools/runs/liquid_metrics.h"

namespace kappaflow {

RunWriter::RunWriter(const Scene& scene, const Simulation& simulation, const std::vector<MeshFormat>& formats,
                     RunFolder& folder)
    : scene_(scene),
      simulation_(simulation),
      folder_(folder),
      walls_move_(any_moves(simulation.walls())),
      walls_(simulation.walls()),
      writer_(scene.output, scene.surface.methods, simulation.surfaces(), simulation.tracers(), formats,
              folder) {
  if (!walls_move_ && !simulation.walls().empty())
    folder.write_boundary(*boundary_data(surfaces_of(simulation.walls())));
}

void RunWriter::write(int frame, double time, const SinceFrame& since_frame, RunSummary& summary) {
  const Stopwatch watch;
  if (walls_move_) move_walls(frame, time);
  const Particles& particles = simulation_.particles();
  const ParticleFieldOptions& options = simulation_.surfaces().field_options();
  const std::vector<float> density = simulation_.fluid().densities(),
                           pressure = simulation_.fluid().pressures();
  const std::vector<double> weight = field_weights(particles.position, options.sigma, options.weights);
  writer_.write(liquid_metrics(frame, time, density, since_frame),
                {particles, density, pressure, simulation_.fluid().sources(), weight, options.sigma},
                {since_frame.surfaces, since_frame.tracer_seconds, since_frame.solver_seconds}, watch,
                summary);
}

FrameMetrics RunWriter::liquid_metrics(int frame, double time, std::span<const float> density,
                                       const SinceFrame& since_frame) const {
  FrameMetrics metrics;
  metrics.frame = frame;
  metrics.time = time;
  metrics.penetration_max = penetration_max(simulation_.particles().position, walls_, scene_.fluid.spacing);
  const Compression now = compression(density, scene_.fluid.density);
  metrics.density_error_mean = std::max(now.mean, since_frame.density_error_mean);
  metrics.density_error_max = std::max(now.max, since_frame.density_error_max);
  return metrics;
}

void RunWriter::move_walls(int frame, double time) {
  const std::vector<SolidWall> walls = walls_at(time, simulation_.walls());
  walls_ = WallDistance(walls);
  folder_.write_boundary(frame, *boundary_data(surfaces_of(walls)));
}

}  // namespace kappaflow
