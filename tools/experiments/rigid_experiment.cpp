#include "tools/experiments/rigid_experiment.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "core/errors.h"
#include "core/parallel.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"

namespace kappaflow {
namespace {

double distance_from_axis(const Vec3& x, const SteadyMotion& motion, const Vec3& centre) {
  const double rate = motion.angular_velocity.norm();
  return rate > 0 ? x.cross(motion.angular_velocity).norm() / rate : (x - centre).norm();
}

double body_size(const TriangleMesh& mesh, const SteadyMotion& motion) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& x : mesh.position) centre += x / static_cast<double>(mesh.vertex_count());
  double size = 0;
  for (const Vec3& x : mesh.position) size = std::max(size, distance_from_axis(x, motion, centre));
  return size;
}

RigidSample sample(const TriangleMesh& mesh, const SteadyMotion& motion, double time, double size,
                   std::size_t unprojected) {
  const auto error = [&](std::size_t v) {
    return (mesh.position[v] - motion.position(mesh.rest_position[v], time)).norm() / size;
  };
  RigidSample s;
  s.cycle = time;
  s.mean_error = parallel_sum(mesh.vertex_count(), 0.0, error) / static_cast<double>(mesh.vertex_count());
  s.max_error = parallel_max(mesh.vertex_count(), 0.0, error);
  s.quality = triangle_qualities(mesh.position, mesh.triangles);
  s.distortion = triangle_distortion(mesh.position, mesh.rest_position, mesh.triangles);
  s.unprojected = unprojected;
  return s;
}

}  // namespace

TriangleMesh start_mesh(const RigidExperiment& experiment, const TrackedBody& body, const std::string& file) {
  RigidParticles at_start(body.particles, body.threshold, experiment.motion, 0, 1);
  TriangleMesh mesh = initial_mesh(*at_start.at(0), body.edge_length, experiment.tracker.projection);
  if (mesh.triangles.empty())
    throw InvalidInput({file},
                       fmt::format("body \"{}\" has no surface at threshold {}", body.name, body.threshold));
  return mesh;
}

void run_rigid_case(const RigidExperiment& experiment, const TriangleMesh& start,
                    const VelocityFunction& velocity, RigidCase& c) {
  TrackerOptions options = experiment.tracker;
  options.method = velocity;
  options.integrator = c.integrator;
  options.fairing.iterations = c.fairing_iterations;
  SurfaceTracker tracker(start, options);
  c.size = body_size(start, experiment.motion);
  c.samples.push_back(sample(start, experiment.motion, 0, c.size, 0));
  const auto keep = [&](int cycle) {
    if (std::ranges::count(experiment.picture_cycles, cycle) > 0) c.kept.push_back(tracker.mesh());
  };
  keep(0);
  for (int n = 1; n <= experiment.cycles * experiment.steps_per_cycle; ++n) {
    const double t0 = static_cast<double>(n - 1) / experiment.steps_per_cycle,
                 t1 = static_cast<double>(n) / experiment.steps_per_cycle;
    RigidParticles motion(c.body->particles, c.body->threshold, experiment.motion, t0, t1);
    const TrackerStep step = tracker.step(motion);
    c.samples.push_back(sample(tracker.mesh(), experiment.motion, t1, c.size, step.unprojected));
    if (n % experiment.steps_per_cycle == 0) keep(n / experiment.steps_per_cycle);
  }
}

double RigidCase::mean_over_run() const {
  double sum = 0;
  for (std::size_t s = 1; s < samples.size(); ++s) sum += samples[s].mean_error;
  return sum / static_cast<double>(samples.size() - 1);
}

double RigidCase::max_over_run() const {
  double largest = 0;
  for (const RigidSample& s : samples) largest = std::max(largest, s.max_error);
  return largest;
}

std::vector<RigidCase> run_rigid_experiment(const RigidExperiment& experiment,
                                            const ExperimentContext& context) {
  std::vector<RigidCase> cases;
  for (const TrackedBody& body : experiment.bodies) {
    const TriangleMesh start = start_mesh(experiment, body, context.file.string());
    for (const TimeIntegrator integrator : experiment.integrators)
      for (const int fairing : experiment.fairing_iterations)
        for (const std::string& method : experiment.methods) {
          context.say(fmt::format("{}, {}, {}, {} fairing iterations", body.name, method,
                                  name_of(kIntegrators, integrator), fairing));
          cases.push_back({&body, method, integrator, fairing, 0, {}, {}});
          run_rigid_case(experiment, start, velocity_method(method).evaluate, cases.back());
        }
  }
  return cases;
}

std::vector<const RigidCase*> select(const std::vector<RigidCase>& cases,
                                     const std::function<bool(const RigidCase&)>& keep) {
  std::vector<const RigidCase*> selected;
  for (const RigidCase& c : cases)
    if (keep(c)) selected.push_back(&c);
  return selected;
}

const RigidCase& find_case(const std::vector<RigidCase>& cases, std::string_view body,
                           std::string_view method, TimeIntegrator integrator, int fairing_iterations) {
  const auto found = std::ranges::find_if(cases, [&](const RigidCase& c) {
    return c.body->name == body && c.method == method && c.integrator == integrator &&
           c.fairing_iterations == fairing_iterations;
  });
  if (found == cases.end())
    throw InvalidInput(
        fmt::format("the experiment's file leaves out the case that its report is about: {}, {}, {}, {} "
                    "fairing iterations",
                    body, method, name_of(kIntegrators, integrator), fairing_iterations));
  return *found;
}

}  // namespace kappaflow
