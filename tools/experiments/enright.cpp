#include "tools/experiments/enright.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "scenes/toml_reader.h"
#include "surface/field/particle_motion.h"
#include "surface/field/runge_kutta.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"
#include "surface/tracker/origin_map.h"
#include "tools/experiments/enright_flow.h"
#include "tools/experiments/enright_results.h"
#include "tools/experiments/peers.h"
#include "tools/runs/timings.h"

namespace kappaflow {
namespace {

constexpr double kHalfTime = EnrightFlow::kPeriod / 2, kEndTime = EnrightFlow::kPeriod;

// Limits.
constexpr double kReturned = 0.1;    // of the radius: the mean vertex error of a surface that is back
constexpr double kFewFolded = 1e-3;  // of the triangles
constexpr double kLeastAngle = 1;    // [degrees]

// What is claimed.

Claim returns_to_start(bool particles) {
  return {"Enright et al. 2002",
          "The flow is reversible: at T every vertex is back at its start (to 10 % of the radius).",
          particles ? "Mean vertex error [m]. Particles that the sheet has pulled apart no longer make one, "
                      "and their surface breaks "
                      "up; a mesh without remeshing cannot follow that."
                    : "Mean vertex error [m]. On the exact function what is left is the velocity method's "
                      "own error and the mesh's."};
}

const Claim kSoundAtHalfTime{
    "kappaflow", "At T/2 the mesh is still sound: nothing folded, no angle below a degree.",
    "Smallest angle [degrees], or 0 where more than 0.1 % has folded or a vertex is off the surface. "
    "A mesh that keeps its connectivity is drawn out with the sheet, even where it "
    "returns perfectly: the state at T "
    "alone would hide that."};

std::vector<std::string> all_methods() {
  std::vector<std::string> names;
  for (const VelocityMethod& method : velocity_methods()) names.emplace_back(method.name);
  return names;
}

struct EnrightOptions {
  std::string title;
  double spacing = 0, sigma = 0;  ///< of the particles [m], [spacings]; 0 in the exact variant
  Kernels kernels = Kernels::round;
  WeightRule weights = WeightRule::normalised;
  double edge_length = 0;        ///< of the meshes that keep their connectivity [m]
  std::vector<double> remeshed;  ///< edge lengths of those that are remeshed [m]
  std::vector<std::string> methods{all_methods()}, remeshed_methods{"material"};
  std::vector<std::string>
      anchored_methods{};  ///< whose rest positions the particles correct, at edge_length
  int steps = 0;
  TrackerOptions tracker;
};

void read_variant(TomlTable& t, bool particles, EnrightOptions& options) {
  const auto or_before = [](double value) { return value > 0 ? std::optional(value) : std::nullopt; };
  if (particles) {
    options.spacing = t.number("spacing", {0.002, 0.05, false, "m"}, or_before(options.spacing));
    options.sigma = t.number("sigma", {1.2, 6, false, "spacings"}, or_before(options.sigma));
    options.kernels = t.choice("kernels", kKernels, std::optional(options.kernels));
    options.weights = t.choice("weights", kWeightRules, std::optional(options.weights));
  }
  const std::vector<std::string> known = all_methods();
  const std::vector<std::string_view> names(known.begin(), known.end());
  if (particles) options.anchored_methods = t.names("anchored_methods", names, options.anchored_methods);
  options.edge_length = t.number("edge_length", {0.002, 0.1, false, "m"}, or_before(options.edge_length));
  options.remeshed = t.numbers("remeshed_edge_lengths", {0.002, 0.1, false, "m"}, options.remeshed);
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

/// A variant of the test.
struct Variant {
  std::function<std::unique_ptr<FieldMotion>(double t0, double t1)>
      motion;                                       ///< its field between any two times
  std::function<OriginMap(double time)> origins{};  ///< at the end of the motion asked for last; of particles
};

/// The trackers of a variant, each with the start of its result.
struct Contest {
  std::vector<SurfaceTracker> trackers;
  std::vector<EnrightResult> results;

  void add(const TriangleMesh& start, const std::string& method, const TrackerOptions& options,
           bool anchored = false) {
    TrackerOptions tracker = options;
    tracker.method = velocity_method(method).evaluate;
    const double edge = tracker.remeshing.edge_length;
    const std::string name =
        edge > 0 ? fmt::format("{} {} {}", method, anchored ? "anchored" : "remeshed", edge) : method;
    trackers.emplace_back(start, tracker);
    results.push_back({name,
                       method,
                       edge,
                       anchored,
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
  tracker.remeshing.edge_length = options.edge_length;
  tracker.remeshing.turn = options.tracker.remeshing.turn;
  for (const std::string& method : options.anchored_methods) contest.add(start, method, tracker, true);
  return contest;
}

/// Makes the fields of a step, which all trackers share.
void make_fields(FieldMotion& motion, TimeIntegrator integrator) {
  const double dt = motion.t1() - motion.t0();
  for (const RungeKuttaStage& stage : runge_kutta_stages(integrator))
    motion.at(stage.time == 1 ? motion.t1() : motion.t0() + stage.time * dt);
  motion.at(motion.t1());
}

std::vector<EnrightResult> track_all(const EnrightOptions& options, const Variant& variant,
                                     const ExperimentContext& context, const EnrightShape& at_half,
                                     const EnrightShape& at_end) {
  const double dt = EnrightFlow::kPeriod / options.steps;
  Contest contest = make_contest(options, *variant.motion(0, dt)->at(0));
  for (int n = 0; n < options.steps; ++n) {
    context.say(fmt::format("step {} of {}", n + 1, options.steps));
    const Stopwatch watch;
    const auto motion = variant.motion(n * dt, n + 1 == options.steps ? kEndTime : (n + 1) * dt);
    make_fields(*motion, options.tracker.integrator);
    std::optional<OriginMap> origins;
    if (!options.anchored_methods.empty()) origins.emplace(variant.origins(motion->t1()));
    const double shared_seconds = watch.seconds();
    for (std::size_t m = 0; m < contest.trackers.size(); ++m) {
      SurfaceTracker& tracker = contest.trackers[m];
      EnrightResult& result = contest.results[m];
      const TrackerStep step = tracker.step(*motion);
      result.seconds += shared_seconds + step.velocity_seconds + step.fairing_seconds +
                        step.topology_seconds + step.remesh_seconds;
      if (result.anchored) result.seconds += seconds_of([&] { correct_origins(*origins, tracker.mesh()); });
      const bool half = 2 * (n + 1) == options.steps, end = n + 1 == options.steps;
      if (!half && !end) continue;
      const auto field = motion->at(motion->t1());
      const TrackerStep settled = tracker.settle(*field);
      result.seconds += settled.topology_seconds + settled.remesh_seconds;
      if (result.anchored) correct_origins(*origins, tracker.mesh());
      (half ? result.half : result.end) = measure(tracker, *field, half ? at_half : at_end);
    }
  }
  return std::move(contest.results);
}

void judge(const std::vector<EnrightResult>& results, bool particles, Report& report) {
  std::vector<Check> returns, sound;
  for (const EnrightResult& r : results) {
    returns.push_back(at_most(r.method, r.end.vertex.mean, kReturned * EnrightFlow::kRadius));
    const bool whole = r.half.folded < kFewFolded && r.half.unprojected == 0;
    sound.push_back(at_least(r.method, whole ? r.half.smallest_angle : 0, kLeastAngle));
  }
  report.statements = {judged(returns_to_start(particles), returns), judged(kSoundAtHalfTime, sound)};
}

std::vector<EnrightResult> track_all(const EnrightOptions& options, const Variant& variant,
                                     const ExperimentContext& context) {
  const double resolution = context.options.quick ? kQuickEnrightResolution : kEnrightResolution;
  const EnrightShape at_half(kHalfTime, resolution), at_end(kEndTime, resolution);
  return track_all(options, variant, context, at_half, at_end);
}

Report enright(const ExperimentContext& context, const EnrightOptions& options, bool particles,
               const Variant& variant, const std::string& introduction) {
  const std::vector<EnrightResult> results = track_all(options, variant, context);
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
  write_results(results, context, report);
  report.tables = {result_table(results), enright_programs(context)};
  return report;
}

ParticleFieldOptions field_of(const EnrightParticles& particles, const EnrightOptions& options) {
  ParticleFieldOptions field{
      .sigma = options.sigma * options.spacing, .weights = options.weights, .kernels = options.kernels};
  field.threshold = particles.threshold(field);
  return field;
}

Variant variant_of(EnrightParticles& particles, const ParticleFieldOptions& field) {
  Variant variant;
  variant.motion = [&particles, field, shapes = std::shared_ptr<const KernelShapes>(), known_at = kInfinity](
                       double t0, double t1) mutable -> std::unique_ptr<FieldMotion> {
    const Particles before = particles.at(t0);
    auto motion =
        std::make_unique<ParticleMotion>(before, particles.at(t1), field, t0 == known_at ? shapes : nullptr);
    shapes = motion->shapes_t1();
    known_at = t1;
    return motion;
  };
  variant.origins = [&particles, start = particles.at(0).position, sigma = field.sigma](double time) {
    return OriginMap(particles.at(time), start, {}, sigma);
  };
  return variant;
}

std::unique_ptr<FieldMotion> exact_motion(double t0, double t1) {
  return std::make_unique<EnrightMotion>(t0, t1);
}

}  // namespace

std::vector<EnrightResult> remeshed_in_enright(const ExperimentContext& context, bool on_particles) {
  EnrightOptions options = read_options(context, on_particles, context.options.quick);
  options.methods.clear();
  options.anchored_methods.clear();
  options.remeshed = {options.edge_length};
  if (!on_particles) return track_all(options, {exact_motion}, context);
  EnrightParticles particles(options.spacing);
  return track_all(options, variant_of(particles, field_of(particles, options)), context);
}

Report experiment_enright_particles(const ExperimentContext& context) {
  const EnrightOptions options = read_options(context, true, context.options.quick);
  EnrightParticles particles(options.spacing);
  const ParticleFieldOptions field = field_of(particles, options);
  const std::size_t count = particles.at(0).size();
  return enright(
      context, options, true, variant_of(particles, field),
      fmt::format("{} particles, on shells {} m apart at the start, are carried by the flow exactly; the "
                  "surface is that of Eq. 12 with sigma = {} m, {} kernels, {} weights, and the threshold "
                  "{:.4f} that "
                  "puts it on the sphere then.",
                  count, options.spacing, field.sigma, name_of(kKernels, field.kernels),
                  name_of(kWeightRules, field.weights), field.threshold));
}

Report experiment_enright_exact(const ExperimentContext& context) {
  const EnrightOptions options = read_options(context, false, context.options.quick);
  return enright(context, options, false, {exact_motion},
                 "The surface is the exact image of the sphere: its implicit function at the point that the "
                 "flow came from, with all derivatives.");
}

}  // namespace kappaflow
