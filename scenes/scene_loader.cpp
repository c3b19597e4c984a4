// Reads a scene: one function a table of the file. Start reading at load_scene().
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenes/heat.h"
#include "scenes/materials.h"
#include "scenes/scene.h"
#include "scenes/solids.h"
#include "solver/emitter.h"
#include "surface/tracker/surface_methods.h"

namespace kappaflow {
namespace {

constexpr double kMaxTension = 1e6;  // [N/m]
constexpr double kMaxFrames = 1e6;
constexpr std::size_t kMaxOutflows = 255, kMaxBodies = 1000;
constexpr int kMaxIterations = 100000;

FluidBlock read_block(TomlTable t, Fluids& fluids) {
  enum class Kind { box, sphere, mesh };
  static constexpr Named<Kind> kKinds[] = {
      {"box", Kind::box}, {"sphere", Kind::sphere}, {"mesh", Kind::mesh}};
  FluidBlock block;
  block.where = t.where();
  const Kind kind = t.choice("shape", kKinds, {});
  block.velocity = t.vector("velocity", "m/s", block.velocity);
  block.fluid = fluids.read(t);
  block.temperature = read_temperature(t, fluids.options().heat);
  if (kind == Kind::box)
    block.shape = read_box(t);
  else if (kind == Kind::sphere)
    block.shape = read_sphere(t);
  else
    block.shape = read_mesh(t);
  if (block.velocity.norm() > kMaxSpeed)
    t.refuse("velocity", fmt::format("at most {} m/s in length", kMaxSpeed));
  return block;
}

/// A number, or rows [time, speed].
void read_speed(TomlTable& t, Emitter& emitter) {
  const NumberRange range = non_negative("m/s", kMaxSpeed);
  const auto rows = t.rows("speed", 1, range,
                           fmt::format("a number, or rows [time, speed] with ascending times >= 0 [s] and "
                                       "speeds >= 0 and <= {} [m/s]",
                                       kMaxSpeed));
  if (rows.empty()) emitter.speed = t.number("speed", positive("m/s", kMaxSpeed));
  for (const auto& row : rows) emitter.ramp.keys.push_back({row[0], row[1]});
}

/// 3 numbers, or rows [time, x, y, z]; then gravity is that at t = 0.
void read_gravity(TomlTable& t, FluidOptions& fluid) {
  const NumberRange range{-kMaxSpeed, kMaxSpeed, false, "m/s2"};
  const auto rows = t.rows("gravity", 3, range,
                           fmt::format("3 numbers, [x, y, z] [m/s2], or rows [time, x, y, z] with ascending "
                                       "times >= 0 [s] and components from -{0} to {0} [m/s2]",
                                       kMaxSpeed));
  if (rows.empty()) fluid.gravity = t.vector("gravity", "m/s2", fluid.gravity);
  for (const auto& row : rows) fluid.gravity_table.keys.push_back({row[0], Vec3(row[1], row[2], row[3])});
  if (!rows.empty()) fluid.gravity = fluid.gravity_table.at(0);
}

Emitter read_emitter(TomlTable t, Fluids& fluids) {
  enum class Kind { disc, rectangle };
  static constexpr Named<Kind> kKinds[] = {{"disc", Kind::disc}, {"rectangle", Kind::rectangle}};
  static constexpr Named<FlowProfile> kProfiles[] = {{"uniform", FlowProfile::uniform},
                                                     {"parabolic", FlowProfile::parabolic}};
  Emitter emitter;
  if (t.choice("shape", kKinds, {}) == Kind::disc) {
    emitter.mouth = DiscMouth{t.number("radius", length_range())};
  } else {
    RectangleMouth mouth{t.number("width", length_range()), t.number("height", length_range())};
    mouth.up = t.vector("up", "", mouth.up);
    emitter.mouth = mouth;
  }
  emitter.position = t.vector("position", "m");
  emitter.direction = t.vector("direction", "");
  read_speed(t, emitter);
  emitter.profile = t.choice("profile", kProfiles, std::optional(emitter.profile));
  emitter.motion = read_motion(t);
  emitter.start = t.number("start", non_negative("s", kMaxTime), emitter.start);
  if (t.has("end")) emitter.end = t.number("end", positive("s", kMaxTime));
  if (t.has("particle_limit"))
    emitter.max_particles =
        static_cast<std::size_t>(t.integer("particle_limit", 1, std::numeric_limits<int>::max()));
  emitter.fluid = fluids.read(t);
  emitter.temperature = read_temperature(t, fluids.options().heat);
  t.finish();
  try {
    check_emitter(emitter, fluids.options().spacing, fluids.options().fluids());
  } catch (const InvalidInput& error) {
    throw InvalidInput(t.where(), error.what());
  }
  return emitter;
}

/// [[outflow]]
Outflow read_outflow(TomlTable t) {
  enum class Kind { box, sphere, cylinder };
  static constexpr Named<Kind> kKinds[] = {
      {"box", Kind::box}, {"sphere", Kind::sphere}, {"cylinder", Kind::cylinder}};
  switch (t.choice("shape", kKinds, {})) {
    case Kind::sphere:
      return {read_sphere(t)};
    case Kind::cylinder:
      return {read_cylinder(t)};
    default:
      return {read_box(t)};
  }
}

void read_fluid(TomlTable t, std::vector<TomlTable> materials, Scene& scene) {
  FluidOptions& fluid = scene.fluid;
  fluid.spacing = t.number("spacing", length_range());
  fluid.density = t.number("density", positive("kg/m3", kMaxDensity), fluid.density);
  Fluids fluids(fluid, scene.materials, std::move(materials));
  const bool has_liquid = fluids.read_first(t);
  fluid.slip_length = t.number_or("free", "slip_length", non_negative("m", kMaxLength), fluid.slip_length)
                          .value_or(std::numeric_limits<double>::infinity());
  fluid.surface_tension =
      t.number("surface_tension", non_negative("N/m", kMaxTension), fluid.surface_tension);
  read_gravity(t, fluid);
  std::vector<TomlTable> emitters = t.tables("emitter"), blocks = t.tables("block", emitters.empty());
  t.finish();
  if (!has_liquid)
    throw InvalidInput(t.where(),
                       "missing the viscosity in [fluid]; required: either kinematic_viscosity [m2/s] or "
                       "dynamic_viscosity [Pa s], or a material");
  if (fluid.gravity.norm() > kMaxSpeed)
    t.refuse("gravity", fmt::format("at most {} m/s2 in length", kMaxSpeed));
  for (TomlTable& table : blocks) scene.blocks.push_back(read_block(std::move(table), fluids));
  for (TomlTable& table : emitters) {
    scene.emitters_where.push_back(table.where());
    fluid.emitters.push_back(read_emitter(std::move(table), fluids));
    fluid.emitters.back().source = static_cast<int>(blocks.size() + fluid.emitters.size() - 1);
  }
  fluids.finish();
  if (blocks.empty() && std::ranges::none_of(fluid.emitters, [](const Emitter& e) { return e.start == 0; }))
    throw InvalidInput(t.where(),
                       "there is no liquid at the start; required: a [[fluid.block]], or a [[fluid.emitter]] "
                       "with start = 0");
}

void read_solver(TomlTable t, FluidOptions& fluid) {
  fluid.cfl = t.number("cfl", positive("", 1), fluid.cfl);
  fluid.min_time_step = t.number("min_time_step", positive("s", kMaxTime), fluid.min_time_step);
  fluid.max_time_step = t.number("max_time_step", positive("s", kMaxTime), fluid.max_time_step);
  fluid.density_tolerance = t.number("density_tolerance", positive("", 1), fluid.density_tolerance);
  fluid.divergence_tolerance = t.number("divergence_tolerance", positive("", 1), fluid.divergence_tolerance);
  fluid.max_pressure_iterations =
      t.integer("max_pressure_iterations", 1, kMaxIterations, fluid.max_pressure_iterations);
  fluid.viscosity_tolerance = t.number("viscosity_tolerance", positive("", 1), fluid.viscosity_tolerance);
  fluid.max_viscosity_iterations =
      t.integer("max_viscosity_iterations", 1, kMaxIterations, fluid.max_viscosity_iterations);
  t.finish();
  if (fluid.min_time_step > fluid.max_time_step)
    t.refuse(t.has("max_time_step") ? "max_time_step" : "min_time_step",
             fmt::format("min_time_step <= max_time_step, here {} and {} [s]", fluid.min_time_step,
                         fluid.max_time_step));
}

void read_tracker(TomlTable& t, TrackerOptions& tracker) {
  VelocityOptions& velocity = tracker.velocity;
  ProjectionOptions& projection = tracker.projection;
  FairingOptions& fairing = tracker.fairing;
  tracker.integrator = t.choice("integrator", kIntegrators, std::optional(tracker.integrator));
  velocity.damping = t.number("damping", positive("", 1e3), velocity.damping);
  velocity.speed_limit = t.number("speed_limit", positive("", 1e3), velocity.speed_limit);
  velocity.row_scale = t.choice("row_scale", kRowScales, std::optional(velocity.row_scale));
  projection.tolerance = t.number("projection_tolerance", positive("sigma", 0.01), projection.tolerance);
  projection.step_limit = t.number("projection_step_limit", positive("sigma", 1), projection.step_limit);
  projection.reach = t.number("projection_reach", positive("sigma", 10), projection.reach);
  projection.iterations = t.integer("projection_iterations", 1, kMaxIterations, projection.iterations);
  fairing.iterations = t.integer("fairing_iterations", 0, kMaxIterations, fairing.iterations);
  fairing.moves = t.choice("fairing_moves", kFairedVertices, std::optional(fairing.moves));
  fairing.relaxation = t.number("fairing_relaxation", positive("", 1), fairing.relaxation);
  fairing.rest_length_time = t.number("rest_length_time", positive("s", kMaxTime), fairing.rest_length_time);
  RemeshOptions& remeshing = tracker.remeshing;
  remeshing.turn = t.number("remesh_turn", positive("rad", 3), remeshing.turn);
  remeshing.finest = t.number("remesh_finest", {0.02, 1, false, "edge_length"}, remeshing.finest);
}

void read_surface(TomlTable t, SurfaceDescription& surface) {
  // Below 1.2 spacings neighbouring particles hardly overlap; above 6 each point has a thousand of them in
  // reach.
  surface.sigma = t.number("sigma", {1.2, 6, false, "spacings"}, surface.sigma);
  surface.weights = t.choice("weights", kWeightRules, std::optional(surface.weights));
  surface.kernels = t.choice("kernels", kKernels, std::optional(surface.kernels));
  surface.threshold = t.number_or("auto", "threshold", positive("", 100), surface.threshold);
  surface.edge_length =
      t.number("edge_length", {kFinestEdge, kCoarsestEdge, false, "sigma"}, surface.edge_length);
  surface.methods = t.names("methods", surface_method_names(), surface.methods);
  surface.anchor = t.choice("anchor", kAnchors, std::optional(surface.anchor));
  surface.motion_per_step = t.number("motion_per_step", positive("sigma", 1e6), surface.motion_per_step);
  surface.remesh = t.flag("remesh", surface.remesh);
  surface.topology = t.flag("topology", surface.topology);
  read_tracker(t, surface.tracker);
  t.finish();
}

void read_output(TomlTable t, double duration, const Vec3& gravity, OutputDescription& output) {
  output.frames_per_second =
      t.number("frames_per_second", positive("1/s", kMaxFrames), output.frames_per_second);
  output.report_axis = t.vector("report_axis", "", output.report_axis);
  output.checker_size = t.number("checker_size", positive("sigma", 1e3), output.checker_size);
  output.texture = t.choice("texture", kTextureProjections, std::optional(output.texture));
  output.checkpoint_interval =
      t.integer("checkpoint_interval", 1, kMaxIterations, output.checkpoint_interval);
  output.metrics_interval = t.integer("metrics_interval", 0, kMaxIterations, output.metrics_interval);
  output.rest_interval = t.integer("rest_interval", 0, kMaxIterations, output.rest_interval);
  const bool falls = gravity.norm() > 0;
  output.view = view_with(t.vector("view_up", "", falls ? Vec3(Vec3::Zero() - gravity) : View{}.up));
  output.view.from = t.vector("view_from", "", output.view.from);
  t.finish();
  if (!(output.report_axis.norm() > 1e-12)) t.refuse("report_axis", "a direction, not the zero vector");
  output.report_axis.normalize();
  if (!(output.view.up.norm() > 1e-12)) t.refuse("view_up", "a direction, not the zero vector");
  if (!is_view(output.view)) t.refuse("view_from", "a direction that is neither zero nor along view_up");
  if (const double frames = duration * output.frames_per_second; frames > kMaxFrames)
    throw InvalidInput(
        t.where(), fmt::format("duration and frames_per_second make {:.3g} frames; allowed: at most {:.0f}",
                               frames, kMaxFrames));
}

}  // namespace

Scene load_scene(const std::filesystem::path& file) {
  return parse_scene(read_small_text_file(file), file);
}

Scene parse_scene(const std::string& text, const std::filesystem::path& file) {
  Scene scene;
  scene.file = file;
  scene.text = text;
  const toml::table document = parse_toml(scene.text, file);

  TomlTable root(document, "the scene", file.string());
  scene.title = root.text("title", file.stem().string());
  scene.duration = root.number("duration", positive("s", kMaxTime));
  TomlTable fluid = root.table("fluid", true), solver = root.table("solver"), surface = root.table("surface"),
            output = root.table("output");
  std::vector<TomlTable> materials = root.tables("material"), walls = root.tables("wall"),
                         bodies = root.tables("body"), outflows = root.tables("outflow");
  const bool has_heat = root.has("heat");
  TomlTable heat = root.table("heat");
  root.finish();

  if (has_heat) scene.fluid.heat = read_heat(std::move(heat));
  read_fluid(std::move(fluid), std::move(materials), scene);
  for (TomlTable& wall : walls) scene.walls.push_back(read_wall(std::move(wall), scene.fluid));
  if (bodies.size() > kMaxBodies)
    throw InvalidInput(bodies[kMaxBodies].where(),
                       fmt::format("{} [[body]]; allowed: {}", bodies.size(), kMaxBodies));
  for (TomlTable& body : bodies) scene.bodies.push_back(read_body(std::move(body), scene.fluid));
  if (outflows.size() > kMaxOutflows)
    throw InvalidInput(outflows[kMaxOutflows].where(),
                       fmt::format("{} [[outflow]]; allowed: {}", outflows.size(), kMaxOutflows));
  for (TomlTable& outflow : outflows) scene.fluid.outflows.push_back(read_outflow(std::move(outflow)));
  read_solver(std::move(solver), scene.fluid);
  read_surface(std::move(surface), scene.surface);
  read_output(std::move(output), scene.duration, scene.fluid.gravity, scene.output);
  return scene;
}

}  // namespace kappaflow
