#include "tools/runs/frame_writer.h"

#include <algorithm>
#include <utility>

#include "surface/measure/texture.h"

namespace kappaflow {

FrameWriter::FrameWriter(const OutputDescription& output, std::vector<std::string> methods,
                         const TrackedSurfaces& surfaces, const MaterialTracers& tracers,
                         std::vector<MeshFormat> formats, RunFolder& folder)
    : output_(output),
      methods_(std::move(methods)),
      surfaces_(surfaces),
      tracers_(tracers),
      formats_(std::move(formats)),
      folder_(folder) {
  const TriangleMesh& mesh = surfaces.mesh();
  first_ = {static_cast<std::int64_t>(mesh.vertex_count()), mesh.vertex_count()};
  initial_box_ = bounding_box(mesh.rest_position);
  last_frame_.assign(methods_.size(), {mesh.next_id, mesh.vertex_count()});
}

void FrameWriter::write(FrameMetrics metrics, const ParticleFrame& particles,
                        const SurfacesSinceFrame& since_frame, const Stopwatch& watch, RunSummary& summary) {
  metrics.particles = particles.particles.size();
  const FreshIsosurface isosurface = fresh_isosurface(surfaces_.field(), surfaces_.field_options().sigma);
  metrics.isosurface = isosurface.metrics;
  folder_.write_particles(metrics.frame, *particle_data(particles));
  const double shared_seconds = watch.seconds();

  const double memory = resident_memory();
  FrameRows rows;
  summary.methods.resize(methods_.size());
  for (std::size_t m = 0; m < methods_.size(); ++m) {
    const Stopwatch surface_watch;
    const std::string& method = methods_[m];
    const MetricsRow row{metrics, method, write_surface(metrics, isosurface.mesh, m, since_frame.steps[m])};
    const PhaseSeconds seconds = phase_seconds(since_frame.steps[m], since_frame.solver_seconds,
                                               shared_seconds + surface_watch.seconds());
    rows.metrics += metrics_row(row);
    rows.pieces += pieces_rows(row);
    rows.timings += timings_row(metrics.frame, metrics.time, method, seconds, memory);
    summary.methods[m].add_frame(method, row.surface, seconds);
  }
  folder_.finish_frame(metrics.time, rows);
  summary.add_frame(metrics, since_frame.tracer_seconds, shared_seconds);
}

SurfaceMetrics FrameWriter::write_surface(const FrameMetrics& frame, const TriangleMesh& isosurface,
                                          std::size_t m, const TrackerStep& since_frame) {
  const SurfaceTracker& tracker = surfaces_.trackers()[m];
  const TriangleMesh& mesh = tracker.mesh();
  const SurfaceState state = surfaces_.state(m);
  const double sigma = surfaces_.field_options().sigma;
  const std::string& method = methods_[m];
  const std::vector<Rgb> checker = checker_colours(mesh.rest_position, output_.checker_size * sigma);
  const std::vector<Vec2> texture = texture_coordinates(mesh.rest_position, initial_box_, output_.texture);
  folder_.write_surface(frame.frame, method, *surface_data({frame.time, mesh, state, checker, texture}));
  for (const MeshFormat format : formats_)
    folder_.write_mesh(frame.frame, method, format,
                       mesh_bytes(format, {mesh.position, state.normal, texture, checker, mesh.triangles}));

  SurfaceMetrics metrics = surface_metrics(surfaces_.field(), isosurface, mesh, state, output_.report_axis);
  metrics.residual_max = std::max(metrics.residual_max, since_frame.residual_max);
  metrics.regions_replaced = since_frame.topology.replaced;
  metrics.regions_refused = since_frame.topology.refused;
  metrics.vertices_replaced = since_frame.topology.vertices_lost;
  metrics.tracer_distance = tracer_distance(mesh, tracers_, sigma);
  metrics.kept_fraction = kept_share(mesh, first_);
  metrics.kept_since_frame = kept_share(mesh, last_frame_[m]);
  last_frame_[m] = {mesh.next_id, mesh.vertex_count()};
  return metrics;
}

/// The share of its vertices that the mesh still has.
double FrameWriter::kept_share(const TriangleMesh& mesh, const Earlier& earlier) {
  if (earlier.vertices == 0) return 1;
  return static_cast<double>(vertices_older_than(mesh, earlier.next_id)) /
         static_cast<double>(earlier.vertices);
}

}  // namespace kappaflow
