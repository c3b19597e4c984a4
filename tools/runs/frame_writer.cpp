#include "tools/runs/frame_writer.h"

#include <fmt/format.h>
#include <vtkPointData.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "core/stopwatch.h"
#include "tools/io/vtk_arrays.h"
#include "tools/io/vtp_files.h"
#include "tools/runs/body_rows.h"
#include "tools/runs/frame_rate.h"
#include "tools/runs/timings.h"

namespace kappaflow {

namespace {

std::vector<Vec3> field_normals(const Field& field, std::span<const Vec3> position) {
  std::vector<Vec3> normal(position.size());
  std::ranges::transform(position, normal.begin(),
                         [&](const Vec3& x) -> Vec3 { return -field.value_and_gradient(x).g.normalized(); });
  return normal;
}

ExportSettings export_settings(const FrameSource& source, const OutputDescription& output,
                               const std::vector<std::string>& methods,
                               const std::vector<MeshFormat>& formats) {
  if (formats.empty()) return {};
  const TriangleMesh& mesh = source.surfaces().mesh();
  ExportSettings settings{.formats = formats,
                          .methods = methods,
                          .up = output.view.up,
                          .texture = {bounding_box(mesh.rest_position), output.texture},
                          .origin = far_origin(mesh.position),
                          .walls_move = source.walls_move(),
                          .has_particles = source.tells_particles()};
  std::vector<double> times;
  for (int frame = 0; frame <= source.last_frame(); ++frame) times.push_back(source.time_of(frame));
  settings.frames_per_second = real_time_rate(times);
  if (const std::vector<TriangleSurface> walls = source.walls_at_start(); !walls.empty())
    settings.walls_at_start = boundary_data(walls);
  return settings;
}

}  // namespace

FrameWriter::FrameWriter(FrameSource& source, const OutputDescription& output,
                         std::vector<std::string> methods, const std::vector<MeshFormat>& formats,
                         RunFolder& folder)
    : output_(output),
      methods_(std::move(methods)),
      surfaces_(std::as_const(source).surfaces()),
      tracers_(source.tracers()),
      last_(source.last_frame()),
      folder_(folder),
      export_(
          std::make_shared<const FrameExport>(export_settings(source, output, methods_, formats),
                                              [&folder](const std::string& name, const std::string& content) {
                                                folder.write_export(name, content);
                                              })) {
  const TriangleMesh& mesh = surfaces_.mesh();
  first_ = {static_cast<std::int64_t>(mesh.vertex_count()), mesh.vertex_count()};
  initial_box_ = bounding_box(mesh.rest_position);
  checker_ = checker_beside(mesh.position, field_normals(surfaces_.field(), mesh.position),
                            output.checker_size * surfaces_.length_scale());
  if (output.rest_interval > 0) rest_pair_.emplace(source.surfaces(), output.rest_interval);
  last_frame_.assign(methods_.size(), {mesh.next_id, mesh.vertex_count()});
  traced_.resize(methods_.size());
  if (const std::vector<TriangleSurface> walls = source.walls_at_start();
      !walls.empty() && !source.walls_move())
    folder.write_boundary(boundary_data(walls));
}

void FrameWriter::write(int frame, FrameSource& source, RunSummary& summary) {
  const Stopwatch watch;
  folder_.wait();  // for the files of the frame before: no more than one is kept in memory
  FrameReport report = source.take_report(frame);
  if (rest_pair_) rest_pair_->update(source.surfaces(), frame);
  FrameMetrics& metrics = report.metrics;
  const FieldMeasures measures = source.measure_field(is_judged(frame), report.particles.particles.position);
  metrics.particles_outside = measures.particles_outside;
  if (measures.isosurface) metrics.isosurface = measures.isosurface->metrics;
  write_walls(report);
  if (const ParticleFieldOptions* field = source.particle_field()) {
    if (report.pieces > 0) source.write_particles(folder_.place(), frame);
    write_particles(report, *field);
  }
  const double shared_seconds = watch.seconds();

  const double memory = resident_memory();
  FrameRows rows;
  summary.methods.resize(methods_.size());
  for (std::size_t m = 0; m < methods_.size(); ++m) {
    const Stopwatch surface_watch;
    const std::string& method = methods_[m];
    const SurfaceMeasures measured = source.measure_surface(m, measures);
    MetricsRow row{metrics, method, write_surface(metrics, m, measured.state, report.steps[m])};
    row.surface.judgement = measured.judgement;
    const PhaseSeconds seconds =
        phase_seconds(report.steps[m], report.liquid_seconds, shared_seconds + surface_watch.seconds());
    rows.metrics += metrics_row(row);
    rows.pieces += pieces_rows(row);
    rows.timings += timings_row(metrics.frame, metrics.time, method, seconds, memory);
    summary.methods[m].add_frame(method, row.surface);
    summary.methods[m].add_seconds(seconds);
  }
  rows.bodies = bodies_rows(frame, metrics.time, report.bodies);
  folder_.beside([to = export_, frame] { to->finish_frame(frame); });
  folder_.finish_frame(metrics.time, rows);
  summary.add_frame(metrics, report.tracer_seconds, shared_seconds);
}

void FrameWriter::write_walls(const FrameReport& report) {
  if (report.walls.empty()) return;
  const int frame = report.metrics.frame;
  const auto walls = boundary_data(report.walls);
  folder_.write_boundary(frame, walls);
  folder_.beside([to = export_, frame, walls] { to->write_walls(frame, *walls); });
}

void FrameWriter::write_particles(const FrameReport& report, const ParticleFieldOptions& field) {
  const int frame = report.metrics.frame;
  const Particles& particles = report.particles.particles;
  const std::vector<double> weight =
      field_weights(particles.position, field.sigma, field.weights, particles.scale);
  const auto data = particle_data(report.particles, weight, field.sigma);
  if (report.pieces > 0) return folder_.list_particles(frame, report.ranks, report.pieces, *data);
  folder_.write_particles(frame, data);
  folder_.beside([to = export_, frame, data] { to->write_particles(frame, *data); });
}

/// Frame 0 is, every metrics_interval-th after it, and the last one.
bool FrameWriter::is_judged(int frame) const {
  return output_.metrics_interval > 0 && (frame % output_.metrics_interval == 0 || frame == last_);
}

SurfaceMetrics FrameWriter::write_surface(const FrameMetrics& frame, std::size_t m, const SurfaceState& state,
                                          const TrackerStep& since_frame) {
  const TriangleMesh& mesh = surfaces_.mesh(m);
  write_mesh(frame, m, state);
  SurfaceMetrics metrics = surface_metrics(surfaces_.field(), mesh, state, output_.report_axis);
  metrics.residual_max = std::max(metrics.residual_max, since_frame.residual_max);
  metrics.regions_replaced = since_frame.topology.replaced;
  metrics.regions_refused = since_frame.topology.refused;
  metrics.vertices_replaced = since_frame.topology.vertices_lost;
  measure_texture(frame.frame, m, metrics);
  metrics.kept_fraction = kept_share(mesh, first_);
  metrics.kept_since_frame = kept_share(mesh, last_frame_[m]);
  last_frame_[m] = {mesh.next_id, mesh.vertex_count()};
  return metrics;
}

/// The flicker of a judged frame takes the texture of the frame before it too.
void FrameWriter::measure_texture(int frame, std::size_t m, SurfaceMetrics& metrics) {
  const double sigma = surfaces_.length_scale();
  const TracedTexture before = std::exchange(traced_[m], {});
  if (is_judged(frame) || is_judged(frame + 1))
    traced_[m] = traced_texture(surfaces_.mesh(m), tracers_, sigma);
  if (!is_judged(frame)) return;
  metrics.tracer_distance = tracer_distance(surfaces_.mesh(m), tracers_, sigma);
  metrics.texture_distance = texture_distance(traced_[m], tracers_, sigma);
  metrics.texture_flicker = texture_flicker(before, traced_[m], sigma);
}

vtkSmartPointer<vtkPolyData> FrameWriter::file_data(const FrameMetrics& frame, std::size_t m,
                                                    const SurfaceState& state,
                                                    std::span<const Vec2> texture) const {
  auto data = surface_data({frame.time, surfaces_.mesh(m), state, checker_, texture});
  if (!rest_pair_) return data;
  for (const int which : {0, 1}) {
    const auto rest = surfaces_.mesh(m).array<Vec3>(RestPair::kNames[which]);
    const auto coordinates = texture_coordinates(rest, rest_pair_->box(which), output_.texture);
    data->GetPointData()->AddArray(make_array(fmt::format("texture_{}", which + 1).c_str(), 2, coordinates));
  }
  return data;
}

void FrameWriter::write_mesh(const FrameMetrics& frame, std::size_t m, const SurfaceState& state) {
  const TriangleMesh& mesh = surfaces_.mesh(m);
  const std::vector<Vec2> texture = texture_coordinates(mesh.rest_position, initial_box_, output_.texture);
  const auto surface = file_data(frame, m, state, texture);
  folder_.write_surface(frame.frame, methods_[m], surface);
  if (export_->asked_for())
    folder_.beside([to = export_, number = frame.frame, method = methods_[m], surface] {
      to->write_surface(number, method, *surface);
    });
}

/// The share of its vertices that the mesh still has.
double FrameWriter::kept_share(const TriangleMesh& mesh, const Earlier& earlier) {
  if (earlier.vertices == 0) return 1;
  return static_cast<double>(vertices_older_than(mesh, earlier.next_id)) /
         static_cast<double>(earlier.vertices);
}

}  // namespace kappaflow
