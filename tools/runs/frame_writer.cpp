#include "tools/runs/frame_writer.h"

#include <algorithm>
#include <utility>

#include "surface/measure/texture.h"

namespace kappaflow {

FrameWriter::FrameWriter(const OutputDescription& output, const TrackedSurfaces& surfaces,
                         std::vector<MeshFormat> formats, RunFolder& folder)
    : output_(output), surfaces_(surfaces), formats_(std::move(formats)), folder_(folder) {
  const TriangleMesh& mesh = surfaces.trackers().front().mesh();
  first_ = {static_cast<std::int64_t>(mesh.vertex_count()), mesh.vertex_count()};
  initial_box_ = bounding_box(mesh.rest_position);
  last_frame_.assign(surfaces.trackers().size(), {mesh.next_id, mesh.vertex_count()});
}

void FrameWriter::write(FrameMetrics metrics, const ParticleFrame& particles, SurfacesSinceFrame since_frame,
                        const Stopwatch& watch, RunSummary& summary) {
  metrics.particles = particles.particles.size();
  const TriangleMesh isosurface =
      measure_isosurface(surfaces_.field(), surfaces_.field_options().sigma, metrics);
  folder_.write_particles(metrics.frame, *particle_data(particles));
  const double shared_seconds = watch.seconds();

  const double memory = resident_memory();
  FrameRows rows;
  summary.methods.resize(surfaces_.trackers().size());
  for (std::size_t m = 0; m < surfaces_.trackers().size(); ++m) {
    const Stopwatch surface_watch;
    const std::string method(surfaces_.trackers()[m].method().name);
    const SurfaceMetrics surface = write_surface(metrics, isosurface, m, since_frame);
    since_frame.seconds[m].output = shared_seconds + surface_watch.seconds();
    rows.metrics += metrics_row(metrics, method, surface);
    rows.pieces += pieces_rows(metrics, method, surface);
    rows.timings += timings_row(metrics.frame, metrics.time, method, since_frame.seconds[m], memory);
    summary.methods[m].add_frame(method, surface, since_frame.seconds[m]);
  }
  folder_.finish_frame(metrics.time, rows);
  summary.add_frame(metrics, since_frame.tracer_seconds, shared_seconds);
}

SurfaceMetrics FrameWriter::write_surface(const FrameMetrics& frame, const TriangleMesh& isosurface,
                                          std::size_t m, const SurfacesSinceFrame& since_frame) {
  const SurfaceTracker& tracker = surfaces_.trackers()[m];
  const TriangleMesh& mesh = tracker.mesh();
  const Field& field = surfaces_.field();
  const SurfaceState state =
      surface_state(field, mesh, tracker.rings(), tracker.method(), tracker.options().velocity);
  const double sigma = surfaces_.field_options().sigma;
  const std::string method(tracker.method().name);
  const std::vector<Rgb> checker = checker_colours(mesh.rest_position, output_.checker_size * sigma);
  const std::vector<Vec2> texture = texture_coordinates(mesh.rest_position, initial_box_, output_.texture);
  folder_.write_surface(frame.frame, method, *surface_data({frame.time, mesh, state, checker, texture}));
  for (const MeshFormat format : formats_)
    folder_.write_mesh(frame.frame, method, format,
                       mesh_text(format, {mesh.position, state.normal, texture, checker, mesh.triangles}));

  SurfaceMetrics metrics = surface_metrics(field, isosurface, mesh, state, output_.report_axis);
  metrics.residual_max = std::max(metrics.residual_max, since_frame.residual_max[m]);
  metrics.regions_replaced = since_frame.topology[m].replaced;
  metrics.regions_refused = since_frame.topology[m].refused;
  metrics.vertices_replaced = since_frame.topology[m].vertices_lost;
  metrics.tracer_distance = tracer_distance(mesh, surfaces_.tracers(), sigma);
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
