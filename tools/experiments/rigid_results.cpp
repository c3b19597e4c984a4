// What the experiments with rigid bodies write and draw.
#include <fmt/format.h>

#include <algorithm>

#include "surface/measure/texture.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/motion/velocity_methods.h"
#include "tools/experiments/rigid_experiment.h"
#include "tools/io/files.h"
#include "tools/io/vtp_files.h"
#include "tools/pictures/picture.h"

namespace kappaflow {
namespace {

std::string case_columns(const RigidCase& c) {
  return fmt::format("{},{},{},{}", c.body->name, c.method, name_of(kIntegrators, c.integrator),
                     c.fairing_iterations);
}

std::string errors_csv(const std::vector<RigidCase>& cases) {
  std::string text =
      "body,method,integrator,fairing_iterations,cycle,mean_error,max_error,quality_min,quality_mean,aspect_"
      "mean,"
      "aspect_max,area_ratio_min,area_ratio_max,unprojected\n";
  for (const RigidCase& c : cases)
    for (const RigidSample& s : c.samples)
      text += fmt::format("{},{:.6g},{:.10g},{:.10g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{}\n",
                          case_columns(c), s.cycle, s.mean_error, s.max_error, s.quality.min, s.quality.mean,
                          s.distortion.aspect_mean, s.distortion.aspect_max, s.distortion.area_ratio_min,
                          s.distortion.area_ratio_max, s.unprojected);
  return text;
}

std::string summary_csv(const RigidExperiment& experiment, const std::vector<RigidCase>& cases) {
  std::string text =
      "body,method,integrator,fairing_iterations,vertices,size,end_error,mean_over_run,max_over_run,"
      "aspect_max_at_end,area_ratio_min_at_end,area_ratio_max_at_end,unprojected_at_end\n";
  for (const RigidCase& c : cases) {
    const RigidSample& end = c.samples.back();
    text += fmt::format("{},{},{:.10g},{:.10g},{:.10g},{:.10g},{:.6g},{:.6g},{:.6g},{}\n", case_columns(c),
                        c.kept.empty() ? 0 : c.kept.front().vertex_count(), c.size,
                        c.end_error(experiment.cycles, experiment.steps_per_cycle), c.mean_over_run(),
                        c.max_over_run(), end.distortion.aspect_max, end.distortion.area_ratio_min,
                        end.distortion.area_ratio_max, end.unprojected);
  }
  return text;
}

vtkSmartPointer<vtkPolyData> mesh_data(const RigidExperiment& experiment, const RigidCase& c,
                                       const TriangleMesh& mesh, double time) {
  RigidParticles particles(c.body->particles, c.body->threshold, experiment.motion, time, time + 1);
  const SurfaceState state =
      surface_state(*particles.at(time), mesh, vertex_rings(mesh.vertex_count(), mesh.triangles),
                    velocity_method(c.method).evaluate, experiment.tracker.velocity);
  return surface_data({time, mesh, state, Checker{.edge = experiment.checker_size},
                       texture_coordinates(mesh.rest_position, bounding_box(mesh.rest_position),
                                           TextureProjection::spherical)});
}

}  // namespace

std::vector<std::string> write_rigid_results(const RigidExperiment& experiment,
                                             const std::vector<RigidCase>& cases,
                                             const ExperimentContext& context) {
  write_file(context.folder / "errors.csv", errors_csv(cases));
  write_file(context.folder / "summary.csv", summary_csv(experiment, cases));
  for (const RigidCase& c : cases)
    for (std::size_t k = 0; k < c.kept.size(); ++k) {
      const int cycle = experiment.picture_cycles[k];
      const std::string name = fmt::format("{}-{}-{}-{}_{:02}.vtp", c.body->name, c.method,
                                           name_of(kIntegrators, c.integrator), c.fairing_iterations, cycle);
      write_vtp(context.folder / name, *mesh_data(experiment, c, c.kept[k], cycle));
    }
  return {"summary.csv", "errors.csv"};
}

void draw_rigid_meshes(const RigidExperiment& experiment, const std::vector<const RigidCase*>& cases,
                       const std::string& name, const ExperimentContext& context) {
  constexpr std::size_t kMostColumns = 3;  // more make titles that cannot be read on a page
  const bool turns = experiment.motion.angular_velocity.norm() > 0;
  std::vector<Panel> panels;
  for (std::size_t k = 0; k < experiment.picture_cycles.size(); ++k) {
    const int cycle = experiment.picture_cycles[k];
    const std::string when = cycle == 0 ? "start"
                             : turns    ? fmt::format("{} turn{}", cycle, cycle == 1 ? "" : "s")
                                        : std::string("end");
    for (const RigidCase* c : cases) {
      const auto data = mesh_data(experiment, *c, c->kept[k], cycle);
      panels.push_back({cycle == 0 ? when : fmt::format("{}, {}", c->method, when), data});
      if (cycle == 0 && cases.size() > kMostColumns) break;  // the same of all methods
    }
  }
  PictureStyle style{.columns = static_cast<int>(std::min(cases.size(), kMostColumns)),
                     .panel_width = 480,
                     .panel_height = 440};
  style.edges = true;
  style.view.from = Vec3(0.3, 0.35, 1);
  draw_picture(context.folder / (name + ".png"), panels, {}, std::nullopt, style);
}

std::string rigid_setting(const RigidExperiment& experiment) {
  std::string text;
  for (const TrackedBody& body : experiment.bodies)
    text += fmt::format("Body *{}*: {} particle{}, threshold {}, mesh edges {} m. ", body.name,
                        body.particles.position.size(), body.particles.position.size() == 1 ? "" : "s",
                        body.threshold, body.edge_length);
  const bool turns = experiment.motion.angular_velocity.norm() > 0;
  text += turns ? fmt::format("{} turns of {} steps. ", experiment.cycles, experiment.steps_per_cycle)
                : fmt::format("{} steps over a distance of {:.3g} m. ", experiment.steps_per_cycle,
                              experiment.motion.velocity.norm());
  text += fmt::format(
      "Damping {}, tangential speed limit {} times the fastest particle in reach, projection to {} sigma. ",
      experiment.tracker.velocity.damping, experiment.tracker.velocity.speed_limit,
      experiment.tracker.projection.tolerance);
  text += turns ? "Errors are distances of vertices from where the rigid motion takes them, in units of the "
                  "body's size, its largest distance from the axis. After whole turns the true place of a "
                  "vertex is where it started, so the *end error* is the paper's error."
                : "Errors are distances of vertices from where the translation takes them, in units of the "
                  "body's largest distance from its centre.";
  return text;
}

}  // namespace kappaflow
