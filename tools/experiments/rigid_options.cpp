// Reads the files of the experiments with rigid bodies, scenes/experiments/*.toml.
#include <fmt/format.h>

#include <numbers>

#include "scenes/toml_reader.h"
#include "surface/motion/velocity_methods.h"
#include "tools/experiments/rigid_experiment.h"

namespace kappaflow {
namespace {

constexpr double kMaxSize = 1e3;  // [m] of a body and of its motion
constexpr int kMaxCount = 100000;

TrackedBody read_body(TomlTable t) {
  TrackedBody body;
  body.name = t.text("name");
  body.threshold = t.number("threshold", positive("", 100));
  for (TomlTable& particle : t.tables("particle", true)) {
    body.particles.position.push_back(particle.vector("position", "m"));
    body.particles.sigma.push_back(particle.number("sigma", positive("m", kMaxSize), 1.0));
    body.particles.weight.push_back(particle.number("weight", positive("", 100), 1.0));
    body.particles.weight_rate.push_back(0);
    particle.finish();
  }
  t.finish();
  return body;
}

/// Turns take a second each, and so does a whole translation.
void read_motion(TomlTable t, RigidExperiment& experiment) {
  enum class Kind { rotation, translation };
  static constexpr Named<Kind> kKinds[] = {{"rotation", Kind::rotation}, {"translation", Kind::translation}};
  if (t.choice("kind", kKinds, {}) == Kind::rotation) {
    const Vec3 axis = t.vector("axis", "");
    experiment.cycles = t.integer("turns", 1, kMaxCount);
    experiment.steps_per_cycle = t.integer("steps_per_turn", 3, kMaxCount);
    t.finish();
    if (!(axis.norm() > 1e-12)) t.refuse("axis", "a direction, not the zero vector");
    experiment.motion.angular_velocity = 2 * std::numbers::pi * axis.normalized();
  } else {
    experiment.motion.velocity = t.vector("displacement", "m");
    experiment.steps_per_cycle = t.integer("steps", 1, kMaxCount);
    t.finish();
  }
}

void read_tracking(TomlTable t, RigidExperiment& experiment, double& edge_length) {
  std::vector<std::string_view> methods, integrators;
  for (const VelocityMethod& method : velocity_methods()) methods.push_back(method.name);
  const std::vector<std::string> all_methods(methods.begin(), methods.end());
  for (const auto& integrator : kIntegrators) integrators.push_back(integrator.name);
  experiment.methods = t.names("methods", methods, all_methods);
  for (const std::string& name : t.names("integrators", integrators, {"rk4"}))
    for (const auto& integrator : kIntegrators)
      if (integrator.name == name) experiment.integrators.push_back(integrator.value);
  experiment.fairing_iterations = t.integers("fairing_iterations", 0, kMaxCount, {0});
  experiment.picture_cycles = t.integers("picture_cycles", 0, kMaxCount, {experiment.cycles});
  experiment.checker_size = t.number("checker_size", positive("m", kMaxSize));
  edge_length = t.number("edge_length", positive("m", kMaxSize));
  experiment.tracker.velocity.damping = t.number("damping", positive("", 1e3));
  experiment.tracker.velocity.speed_limit = t.number("speed_limit", positive("", 1e3));
  experiment.tracker.velocity.row_scale =
      t.choice("row_scale", kRowScales, std::optional(experiment.tracker.velocity.row_scale));
  experiment.tracker.projection.tolerance = t.number("projection_tolerance", positive("sigma", 0.01));
  experiment.tracker.fairing.moves =
      t.choice("fairing_moves", kFairedVertices, std::optional(experiment.tracker.fairing.moves));
  experiment.tracker.fairing.rest_length_time = t.number("rest_length_time", positive("s", 1e9), 1e9);
  t.finish();
}

/// What the quick variant does otherwise.
void read_quick(TomlTable t, RigidExperiment& experiment, double& edge_length) {
  experiment.cycles = t.integer("turns", 1, kMaxCount, experiment.cycles);
  experiment.fairing_iterations =
      t.integers("fairing_iterations", 0, kMaxCount, experiment.fairing_iterations);
  experiment.picture_cycles = t.integers("picture_cycles", 0, kMaxCount, experiment.picture_cycles);
  edge_length = t.number("edge_length", positive("m", kMaxSize), edge_length);
  t.finish();
}

}  // namespace

RigidExperiment read_rigid_experiment(const std::filesystem::path& file, bool quick) {
  const toml::table document = read_toml(file);
  RigidExperiment experiment;
  double edge_length = 0;
  TomlTable root(document, "the experiment", file.string());
  experiment.title = root.text("title");
  TomlTable motion = root.table("motion", true), tracking = root.table("tracking", true),
            quick_values = root.table("quick");
  for (TomlTable& body : root.tables("body", true)) experiment.bodies.push_back(read_body(std::move(body)));
  root.finish();
  read_motion(std::move(motion), experiment);
  read_tracking(std::move(tracking), experiment, edge_length);
  RigidExperiment quick_experiment = experiment;
  double quick_edge_length = edge_length;
  read_quick(std::move(quick_values), quick_experiment, quick_edge_length);  // its mistakes count always
  if (quick) {
    experiment = quick_experiment;
    edge_length = quick_edge_length;
  }
  for (TrackedBody& body : experiment.bodies) body.edge_length = edge_length;
  for (const int cycle : experiment.picture_cycles)
    if (cycle > experiment.cycles)
      throw InvalidInput({file.string()}, fmt::format("picture_cycles names {}, but there are {} turns",
                                                      cycle, experiment.cycles));
  return experiment;
}

}  // namespace kappaflow
