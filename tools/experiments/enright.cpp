#include "tools/experiments/enright.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "scenes/toml_reader.h"
#include "surface/field/particle_motion.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/mesh/self_intersection.h"
#include "surface/remesh/initial_mesh.h"
#include "tools/experiments/enright_body.h"
#include "tools/experiments/enright_flow.h"
#include "tools/io/files.h"
#include "tools/io/vtp_files.h"
#include "tools/pictures/picture.h"
#include "tools/runs/timings.h"

namespace kappaflow {
namespace {

constexpr double kHalf = EnrightFlow::kPeriod / 2, kEnd = EnrightFlow::kPeriod;

std::vector<std::string> all_methods() {
  std::vector<std::string> names;
  for (const VelocityMethod& method : velocity_methods()) names.emplace_back(method.name);
  return names;
}

struct EnrightOptions {
  std::string title;
  double spacing = 0, sigma = 0;  ///< of the particles [m], [spacings]; 0 in the exact variant
  double edge_length = 0;         ///< of the meshes that keep their connectivity [m]
  std::vector<double> remeshed;   ///< edge lengths of those that are remeshed [m]
  std::vector<std::string> methods{all_methods()}, remeshed_methods{"material"};
  int steps = 0;
  TrackerOptions tracker;
};

void read_variant(TomlTable& t, bool particles, EnrightOptions& options) {
  const auto or_before = [](double value) { return value > 0 ? std::optional(value) : std::nullopt; };
  if (particles) {
    options.spacing = t.number("spacing", {0.002, 0.05, false, "m"}, or_before(options.spacing));
    options.sigma = t.number("sigma", {1.2, 6, false, "spacings"}, or_before(options.sigma));
  }
  options.edge_length = t.number("edge_length", {0.002, 0.1, false, "m"}, or_before(options.edge_length));
  options.remeshed = t.numbers("remeshed_edge_lengths", {0.002, 0.1, false, "m"}, options.remeshed);
  const std::vector<std::string> known = all_methods();
  const std::vector<std::string_view> names(known.begin(), known.end());
  options.methods = t.names("methods", names, options.methods);
  options.remeshed_methods = t.names("remeshed_methods", names, options.remeshed_methods);
  options.steps =
      t.integer("steps", 2, 100000, options.steps > 0 ? std::optional(options.steps) : std::nullopt);
  TrackerOptions& tracker = options.tracker;
  tracker.integrator = t.choice("integrator", kIntegrators, std::optional(tracker.integrator));
  tracker.velocity.damping = t.number("damping", positive("", 1e3), tracker.velocity.damping);
  tracker.velocity.speed_limit = t.number("speed_limit", positive("", 1e3), tracker.velocity.speed_limit);
  tracker.fairing.iterations = t.integer("fairing_iterations", 0, 1000, tracker.fairing.iterations);
  tracker.remeshing.turn = t.number("remesh_turn", positive("rad", 3), tracker.remeshing.turn);
  tracker.remeshing.finest =
      t.number("remesh_finest", {0.02, 1, false, "edge length"}, tracker.remeshing.finest);
  t.finish();
}

EnrightOptions read_options(const ExperimentContext& context, bool particles, bool quick_variant) {
  const toml::table document = read_toml(context.file);
  EnrightOptions options, other;
  TomlTable root(document, "the experiment", context.file.string());
  options.title = root.text("title");
  TomlTable with_particles = root.table("particles", true), exact = root.table("exact", true),
            quick = root.table("quick");
  root.finish();
  TomlTable quick_particles = quick.table("particles"), quick_exact = quick.table("exact");
  quick.finish();
  EnrightOptions &of_particles = particles ? options : other, &of_exact = particles ? other : options;
  read_variant(with_particles, true, of_particles);
  read_variant(exact, false, of_exact);
  const EnrightOptions full = options;
  read_variant(quick_particles, true, of_particles);
  read_variant(quick_exact, false, of_exact);
  if (!quick_variant) options = full;
  if (options.steps % 2 != 0) ++options.steps;  // so that a step ends at half time
  return options;
}

/// A tracked mesh at one time.
struct Sample {
  TriangleMesh mesh;
  SurfaceState state;
  ShapeError shape;
  VertexError vertex;
  double volume = 0;  ///< [m3]
  double mean_quality = 0, smallest_angle = 0, folded = 0;
  std::size_t unprojected = 0, self_intersections = 0;
};

/// One tracked surface over the whole test.
struct MethodResult {
  std::string method;  ///< with "remeshed" and the edge length [m] where it is
  bool remeshed = false;
  std::size_t start_triangles = 0;
  double start_volume = 0;  ///< of the start mesh [m3]
  Sample half, end;
  double seconds = 0;  ///< wall time, the fields that all share included
};

Sample measure(const SurfaceTracker& tracker, const Field& field, const EnrightShape& shape) {
  const TriangleMesh& mesh = tracker.mesh();
  Sample s;
  s.mesh = mesh;
  s.state = surface_state(field, mesh, tracker.rings(), tracker.method(), tracker.options().velocity);
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

/// A variant: its field between any two times of the test.
using MotionBetween = std::function<std::unique_ptr<FieldMotion>(double t0, double t1)>;

/// The trackers of a variant, each with the start of its result.
struct Contest {
  std::vector<SurfaceTracker> trackers;
  std::vector<MethodResult> results;

  void add(const TriangleMesh& start, const std::string& method, const TrackerOptions& options) {
    TrackerOptions tracker = options;
    tracker.method = method;
    const double edge = tracker.remeshing.edge_length;
    const std::string name = edge > 0 ? fmt::format("{} remeshed {}", method, edge) : method;
    trackers.emplace_back(start, tracker);
    results.push_back({name,
                       edge > 0,
                       start.triangles.size(),
                       area_and_volume(start.position, start.triangles).volume,
                       {},
                       {}});
  }
};

Contest make_contest(const EnrightOptions& options, const Field& field) {
  Contest contest;
  TrackerOptions tracker = options.tracker;
  tracker.remeshing.edge_length = 0;
  const TriangleMesh start = initial_mesh(field, options.edge_length, tracker.projection);
  for (const std::string& method : options.methods) contest.add(start, method, tracker);
  // The flow tears the particles' surface; that of the exact function keeps its topology.
  tracker.topology.follows_field = options.spacing > 0;
  for (const double edge : options.remeshed) {
    tracker.remeshing.edge_length = edge;
    // Meshes of different resolution are similar to each other: so are what their chords leave out.
    tracker.remeshing.turn = options.tracker.remeshing.turn * edge / options.edge_length;
    const TriangleMesh remeshed_start = initial_mesh(field, edge, tracker.projection);
    for (const std::string& method : options.remeshed_methods) contest.add(remeshed_start, method, tracker);
  }
  return contest;
}

/// Makes the fields of a step, which all trackers share.
void make_fields(FieldMotion& motion, TimeIntegrator integrator) {
  const double dt = motion.t1() - motion.t0();
  for (const RungeKuttaStage& stage : runge_kutta_stages(integrator))
    motion.at(stage.time == 1 ? motion.t1() : motion.t0() + stage.time * dt);
  motion.at(motion.t1());
}

std::vector<MethodResult> track_all(const EnrightOptions& options, const MotionBetween& motion_between,
                                    const ExperimentContext& context, const EnrightShape& at_half,
                                    const EnrightShape& at_end) {
  const double dt = EnrightFlow::kPeriod / options.steps;
  Contest contest = make_contest(options, *motion_between(0, dt)->at(0));
  for (int n = 0; n < options.steps; ++n) {
    context.say(fmt::format("step {} of {}", n + 1, options.steps));
    const Stopwatch watch;
    const auto motion = motion_between(n * dt, n + 1 == options.steps ? kEnd : (n + 1) * dt);
    make_fields(*motion, options.tracker.integrator);
    const double shared_seconds = watch.seconds();
    for (std::size_t m = 0; m < contest.trackers.size(); ++m) {
      SurfaceTracker& tracker = contest.trackers[m];
      MethodResult& result = contest.results[m];
      const TrackerStep step = tracker.step(*motion);
      result.seconds += shared_seconds + step.velocity_seconds + step.fairing_seconds +
                        step.topology_seconds + step.remesh_seconds;
      const bool half = 2 * (n + 1) == options.steps, end = n + 1 == options.steps;
      if (!half && !end) continue;
      const auto field = motion->at(motion->t1());
      const TrackerStep settled = tracker.settle(*field);
      result.seconds += settled.topology_seconds + settled.remesh_seconds;
      (half ? result.half : result.end) = measure(tracker, *field, half ? at_half : at_end);
    }
  }
  return std::move(contest.results);
}

double volume_change(const MethodResult& r, const Sample& s) {
  return s.volume / r.start_volume - 1;
}

/// Against the sphere itself, not its start mesh, whose chords lie inside.
double volume_error(const Sample& s) {
  return s.volume / (4.0 / 3 * std::numbers::pi * std::pow(EnrightFlow::kRadius, 3)) - 1;
}

std::vector<std::string> table_row(const MethodResult& r, const std::string& when, const Sample& s) {
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

Table result_table(const std::vector<MethodResult>& results) {
  Table table{
      "Mean and largest distances in metres. *Shape error*: from the mesh's vertices, and from points on its "
      "triangles, to the exact shape, and from points of the exact shape to the mesh. *Volume*: against the "
      "start mesh, and against the exact sphere's. *Vertex error*: from each vertex to where the material is "
      "that it claims to be. *Time*: wall time from 0 to T, measures left out.",
      {"method", "at", "triangles", "vertices to shape", "triangles to shape", "shape to mesh", "volume",
       "vertex error", "quality, mean", "smallest angle [degrees]", "folded", "not on the surface",
       "self-intersections", "time [s]"},
      {}};
  for (const MethodResult& r : results) {
    table.rows.push_back(table_row(r, "T/2", r.half));
    table.rows.push_back(table_row(r, "T", r.end));
  }
  return table;
}

/// What programs with remeshing reach, run on the same test.
Table other_programs() {
  return {
      "Other programs, for comparison. All of these remesh, from a start mesh of 6,588 triangles in 300 "
      "steps; distances are those of vertices to the sphere at T.",
      {"program", "triangles at T/2", "volume at T/2, T", "distance mean, max", "smallest angle at T/2",
       "time"},
      {{"El Topo", "25,230", "-0.25 %, -0.18 %", "2.5e-4, 3.1e-3", "11", "275 s"},
       {"LosTopos, edge 0.01", "66,298", "+0.05 %, +0.001 %", "1.1e-4, 2.0e-3", "3", "1,545 s"},
       {"level set (HJ-WENO5), 100^3", "-", "-20 %, -45 %", "-", "-", "-"}}};
}

std::string csv(const std::vector<MethodResult>& results) {
  std::string text =
      "method,time,triangles,vertex_to_shape_mean,vertex_to_shape_max,triangle_to_shape_mean,triangle_to_"
      "shape_max,"
      "shape_to_mesh_mean,shape_to_mesh_max,volume_change,volume_error,vertex_error_mean,vertex_error_max,"
      "quality_mean,"
      "smallest_angle,folded_fraction,unprojected,self_intersections,seconds\n";
  for (const MethodResult& r : results)
    for (const auto& [time, s] : {std::pair{kHalf, &r.half}, std::pair{kEnd, &r.end}})
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

std::string file_name(const MethodResult& r, const std::string& when) {
  std::string name = fmt::format("{}_{}.vtp", r.method, when);
  std::ranges::replace(name, ' ', '-');
  return name;
}

void write_meshes(const std::vector<MethodResult>& results, const ExperimentContext& context,
                  Report& report) {
  for (const auto& [name, time, member] :
       {std::tuple{"half", kHalf, &MethodResult::half}, std::tuple{"end", kEnd, &MethodResult::end}}) {
    std::vector<Panel> panels;
    for (const MethodResult& r : results) {
      const Sample& s = r.*member;
      const auto data = surface_data(
          {time, s.mesh, s.state, checker_colours(s.mesh.rest_position, EnrightFlow::kRadius / 3),
           texture_coordinates(s.mesh.rest_position, bounding_box(s.mesh.rest_position),
                               TextureProjection::spherical)});
      write_vtp(context.folder / file_name(r, name), *data);
      panels.push_back({fmt::format("{}, t = {} s", r.method, time), data});
    }
    const std::string picture = fmt::format("{}-{}.png", context.name, name);
    draw_picture(context.folder / picture, panels, nullptr, nullptr,
                 {.columns = 3, .panel_width = 640, .panel_height = 560, .edges = true});
    report.figures.push_back({picture, time == kHalf ? "The meshes at T/2."
                                                     : "The meshes at T, where the body is a sphere again."});
  }
}

void judge(const std::vector<MethodResult>& results, bool particles, Report& report) {
  std::vector<Check> returns, sound;
  std::string errors, meshes;
  for (const MethodResult& r : results) {
    returns.push_back({r.method, r.end.vertex.mean < 0.1 * EnrightFlow::kRadius});
    sound.push_back({r.method, r.half.folded < 1e-3 && r.half.unprojected == 0 && r.half.smallest_angle > 1});
    errors += fmt::format("{}{} {:.2g}", errors.empty() ? "" : ", ", r.method, r.end.vertex.mean);
    meshes += fmt::format("{}{} {:.1f} degrees, {:.1f} % folded", meshes.empty() ? "" : ", ", r.method,
                          r.half.smallest_angle, 100 * r.half.folded);
  }
  report.statements.push_back(judged(
      "Enright et al. 2002",
      "The flow is reversible: at T every vertex is back at its start (to 10 % of the radius).",
      "mean vertex error [m]: " + errors, returns,
      particles ? "Particles that the sheet has pulled apart no longer make one, and their surface breaks "
                  "up; a mesh without remeshing cannot follow that."
                : "On the exact function what is left is the velocity method's own error and the mesh's."));
  report.statements.push_back(judged(
      "kappaflow", "At T/2 the mesh is still sound: nothing folded, no angle below a degree.", meshes, sound,
      "A mesh that keeps its connectivity is drawn out with the sheet, even where it returns perfectly: the "
      "state at T alone would hide that."));
}

Report enright(const ExperimentContext& context, const EnrightOptions& options, bool particles,
               const MotionBetween& motion_between, const std::string& introduction) {
  const double resolution = context.options.quick ? 0.01 : 0.004;
  const EnrightShape at_half(kHalf, resolution), at_end(kEnd, resolution);
  const std::vector<MethodResult> results = track_all(options, motion_between, context, at_half, at_end);
  Report report;
  report.name = context.name;
  report.title = options.title;
  report.introduction =
      introduction + fmt::format(
                         " Sphere of radius {} m, period {} s, velocity times cos(pi t/T); {} triangles, {} "
                         "steps with {}, damping {}, {} fairing iterations.",
                         EnrightFlow::kRadius, EnrightFlow::kPeriod, results.front().start_triangles,
                         options.steps, name_of(kIntegrators, options.tracker.integrator),
                         options.tracker.velocity.damping, options.tracker.fairing.iterations);
  const EnrightOptions whole = read_options(context, particles, false);
  const auto metres = [](double length) { return fmt::format("{} m", length); };
  const auto list = [](const std::vector<double>& lengths) {
    return fmt::format("{} m", fmt::join(lengths, ", "));
  };
  add_smaller(report, "particle spacing", metres(options.spacing), metres(whole.spacing));
  add_smaller(report, "mesh edges", metres(options.edge_length), metres(whole.edge_length));
  add_smaller(report, "remeshed edges", list(options.remeshed), list(whole.remeshed));
  add_smaller(report, "steps", fmt::format("{}", options.steps), fmt::format("{}", whole.steps));
  judge(results, particles, report);
  write_meshes(results, context, report);
  write_file(context.folder / "enright.csv", csv(results));
  report.tables = {result_table(results), other_programs()};
  report.files = {"enright.csv"};
  return report;
}

}  // namespace

Report experiment_enright_particles(const ExperimentContext& context) {
  const EnrightOptions options = read_options(context, true, context.options.quick);
  EnrightParticles particles(options.spacing);
  ParticleFieldOptions field{.sigma = options.sigma * options.spacing, .weights = WeightRule::normalised};
  field.threshold = particles.threshold(field.sigma);
  const std::size_t count = particles.at(0).size();
  const auto motion_between = [&](double t0, double t1) -> std::unique_ptr<FieldMotion> {
    const Particles before = particles.at(t0);
    return std::make_unique<ParticleMotion>(before, particles.at(t1), field);
  };
  return enright(
      context, options, true, motion_between,
      fmt::format(
          "{} particles, on shells {} m apart at the start, are carried by the flow exactly; the "
          "surface is that of Eq. 12 with sigma = {} m, normalised weights, and the threshold {:.4f} that "
          "puts it on the sphere then.",
          count, options.spacing, field.sigma, field.threshold));
}

Report experiment_enright_exact(const ExperimentContext& context) {
  const EnrightOptions options = read_options(context, false, context.options.quick);
  const auto motion_between = [](double t0, double t1) -> std::unique_ptr<FieldMotion> {
    return std::make_unique<EnrightMotion>(t0, t1);
  };
  return enright(context, options, false, motion_between,
                 "The surface is the exact image of the sphere: its implicit function at the point that the "
                 "flow came from, with all derivatives.");
}

}  // namespace kappaflow
