#include "tools/experiments/enright_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "surface/measure/texture.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/mesh/self_intersection.h"
#include "tools/experiments/enright_flow.h"
#include "tools/io/files.h"
#include "tools/io/vtp_files.h"
#include "tools/pictures/picture.h"

namespace kappaflow {
namespace {

double volume_change(const EnrightResult& r, const EnrightSample& s) {
  return s.volume / r.start_volume - 1;
}

/// Against the sphere itself, not its start mesh, whose chords lie inside.
double volume_error(const EnrightSample& s) {
  return s.volume / (4.0 / 3 * std::numbers::pi * std::pow(EnrightFlow::kRadius, 3)) - 1;
}

std::vector<std::string> table_row(const EnrightResult& r, const std::string& when, const EnrightSample& s) {
  return {r.method,
          when,
          fmt::format("{}", s.mesh.triangles.size()),
          fmt::format("{:.2g}, {:.2g}", s.shape.vertex_mean, s.shape.vertex_max),
          fmt::format("{:.2g}, {:.2g}", s.shape.triangle_mean, s.shape.triangle_max),
          fmt::format("{:.2g}, {:.2g}", s.shape.shape_mean, s.shape.shape_max),
          fmt::format("{:+.3f} %, {:+.3f} %", 100 * volume_change(r, s), 100 * volume_error(s)),
          fmt::format("{:.2g}, {:.2g}", s.vertex.mean, s.vertex.max),
          fmt::format("{:.3f}", s.mean_quality),
          fmt::format("{:.1f}", s.smallest_angle),
          fmt::format("{:.1f} %", 100 * s.folded),
          fmt::format("{}", s.unprojected),
          fmt::format("{}", s.self_intersections),
          fmt::format("{:.0f}", r.seconds)};
}

std::string enright_csv(const std::vector<EnrightResult>& results) {
  std::string text =
      "method,time,triangles,vertex_to_shape_mean,vertex_to_shape_max,triangle_to_shape_mean,triangle_to_"
      "shape_max,"
      "shape_to_mesh_mean,shape_to_mesh_max,volume_change,volume_error,vertex_error_mean,vertex_error_max,"
      "quality_mean,"
      "smallest_angle,folded_fraction,unprojected,self_intersections,seconds\n";
  for (const EnrightResult& r : results)
    for (const auto& [time, s] :
         {std::pair{EnrightFlow::kPeriod / 2, &r.half}, std::pair{EnrightFlow::kPeriod, &r.end}})
      text += fmt::format(
          "{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{"
          ":.6g},"
          "{},{},{:.3g}\n",
          r.method, time, s->mesh.triangles.size(), s->shape.vertex_mean, s->shape.vertex_max,
          s->shape.triangle_mean, s->shape.triangle_max, s->shape.shape_mean, s->shape.shape_max,
          volume_change(r, *s), volume_error(*s), s->vertex.mean, s->vertex.max, s->mean_quality,
          s->smallest_angle, s->folded, s->unprojected, s->self_intersections, r.seconds);
  return text;
}

std::string file_name(const EnrightResult& r, const std::string& when) {
  std::string name = fmt::format("{}_{}.vtp", r.method, when);
  std::ranges::replace(name, ' ', '-');
  return name;
}

void write_meshes(const std::vector<EnrightResult>& results, const ExperimentContext& context,
                  Report& report) {
  for (const auto& [name, time, member] : {std::tuple{"half", EnrightFlow::kPeriod / 2, &EnrightResult::half},
                                           std::tuple{"end", EnrightFlow::kPeriod, &EnrightResult::end}}) {
    std::vector<Panel> panels;
    for (const EnrightResult& r : results) {
      const EnrightSample& s = r.*member;
      const auto data =
          surface_data({time, s.mesh, s.state, Checker{.edge = EnrightFlow::kRadius / 3},
                        texture_coordinates(s.mesh.rest_position, bounding_box(s.mesh.rest_position),
                                            TextureProjection::spherical)});
      write_vtp(context.folder / file_name(r, name), *data);
      panels.push_back({fmt::format("{}, t = {} s", r.method, time), data});
    }
    const std::string picture = fmt::format("{}-{}.png", context.name, name);
    draw_picture(context.folder / picture, panels, {}, std::nullopt,
                 {.columns = 3, .panel_width = 640, .panel_height = 560, .edges = true});
    report.figures.push_back({picture, time < EnrightFlow::kPeriod
                                           ? "The meshes at T/2."
                                           : "The meshes at T, where the body is a sphere again."});
  }
}

}  // namespace

EnrightSample measure(const SurfaceTracker& tracker, const Field& field, const EnrightShape& shape) {
  const TriangleMesh& mesh = tracker.mesh();
  EnrightSample s;
  s.mesh = mesh;
  s.state = surface_state(field, mesh, tracker.rings(), tracker.options().method, tracker.options().velocity);
  s.shape = shape.error(mesh);
  s.vertex = vertex_error(mesh, field.time());
  s.volume = area_and_volume(mesh.position, mesh.triangles).volume;
  s.mean_quality = triangle_qualities(mesh.position, mesh.triangles).mean;
  s.smallest_angle = smallest_angle(mesh.position, mesh.triangles);
  s.folded = folded_fraction(mesh.position, s.state.normal, mesh.triangles);
  s.self_intersections = self_intersections(mesh.position, mesh.triangles);
  s.unprojected = static_cast<std::size_t>(std::ranges::count(mesh.unprojected, 1));
  return s;
}

Table result_table(const std::vector<EnrightResult>& results) {
  Table table{
      "Mean and largest distances in metres. *Shape error*: from the mesh's vertices, and from points on its "
      "triangles, to the exact shape, and from points of the exact shape to the mesh. *Volume*: against the "
      "start mesh, and against the exact sphere's. *Vertex error*: from each vertex to where the material is "
      "that it claims to be. *Time*: wall time from 0 to T, measures left out.",
      {"method", "at", "triangles", "vertices to shape", "triangles to shape", "shape to mesh", "volume",
       "vertex error", "quality, mean", "smallest angle [degrees]", "folded", "not on the surface",
       "self-intersections", "time [s]"},
      {}};
  for (const EnrightResult& r : results) {
    table.rows.push_back(table_row(r, "T/2", r.half));
    table.rows.push_back(table_row(r, "T", r.end));
  }
  return table;
}

void write_results(const std::vector<EnrightResult>& results, const ExperimentContext& context,
                   Report& report) {
  write_meshes(results, context, report);
  write_file(context.folder / "enright.csv", enright_csv(results));
  report.files = {"enright.csv"};
}

}  // namespace kappaflow
