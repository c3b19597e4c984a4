#include "tools/experiments/kernels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "scenes/scene.h"
#include "scenes/toml_reader.h"
#include "surface/field/particle_motion.h"
#include "surface/measure/surface_state.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"
#include "tools/experiments/fibonacci_sphere.h"
#include "tools/experiments/validation.h"
#include "tools/experiments/waviness.h"
#include "tools/io/files.h"
#include "tools/io/particle_file.h"

namespace kappaflow {
namespace {

// Limits.
constexpr double kSmoother = 5;        // times
constexpr double kVolumeError = 0.01;  // relative
constexpr double kThinError = 0.03;    // relative
constexpr double kSlipShare = 1.05;    // of round kernels' slip

// What is claimed.

const Claim kIsSmooth{
    "kappaflow", "Anisotropic kernels make a surface five times smoother.",
    "RMS of its distance from the smooth one, and of the angle between the normals: of a ball "
    "from a lattice, of flat surfaces of shaken particles, and of liquid that has come to rest in a basin."};
const Claim kKeepsVolume{"kappaflow",
                         "They keep the volume of a ball, and sheets and threads of one particle and more.",
                         "Volume, thickness and radius beside those of the particles."};
const Claim kIsFollowed{
    "kappaflow",
    "The regional velocity slips no more on them than on round kernels, where their surfaces are "
    "within a tenth of sigma of each other.",
    "It reads the motion along the surface from the round kernels of the same particles. Elsewhere, at sharp "
    "edges and in what is thin, the surfaces differ, and slips cannot be compared."};

struct KernelsOptions {
  std::string title;
  double sigma = 0, ball = 0, shaken = 0;
  std::vector<double> layers;
  Scene pool;
  std::vector<std::string> frames;
  double edge_length = 0;
  VelocityOptions velocity;
};

KernelsOptions read_options(const ExperimentContext& context, bool quick_variant) {
  const toml::table document = read_toml(context.file);
  TomlTable root(document, "the experiment", context.file.string());
  KernelsOptions o;
  o.title = root.text("title");
  TomlTable still = root.table("still", true), flow = root.table("flow", true), quick = root.table("quick");
  root.finish();
  o.sigma = still.number("sigma", {1.2, 6, false, "spacings"});
  o.ball = still.number("ball", {1, 100, false, "spacings"});
  o.shaken = still.number("shaken", {0, 0.5, true, "spacings"});
  for (const double layers : still.numbers("layers", {1, 20, false, ""}, {}))
    o.layers.push_back(std::floor(layers));
  o.pool = load_scene(context.file.parent_path() / still.text("pool"));
  still.finish();
  o.frames = flow.texts("files");
  o.edge_length = flow.number("edge_length", positive("m", 100));
  o.velocity.damping = flow.number("damping", positive("", 1e3));
  o.velocity.speed_limit = flow.number("speed_limit", positive("", 1e3));
  flow.finish();
  const int quick_frames = quick.integer("frames", 1, static_cast<int>(o.frames.size()), 1);
  const double quick_spacing = quick.number("pool_spacing", positive("m", 1));
  quick.finish();
  if (quick_variant) {
    o.frames.resize(quick_frames);
    o.pool = with_spacing(o.pool, quick_spacing);
  }
  return o;
}

/// The points of a lattice with spacing 1 in |x| <= half.
std::vector<Vec3> lattice_box(const Vec3& half) {
  std::vector<Vec3> x;
  const Vec3 last = (2 * half).array().floor();
  for (int i = 0; i <= last[0]; ++i)
    for (int j = 0; j <= last[1]; ++j)
      for (int k = 0; k <= last[2]; ++k) x.push_back(Vec3(i, j, k) - 0.5 * last);
  return x;
}

/// At rest, with half the field of their inside as threshold.
std::shared_ptr<const Field> field_of(const std::vector<Vec3>& position, double sigma, Kernels kernels) {
  constexpr double kKernelIntegral = 64 * std::numbers::pi / 315;  // of (1 - r^2)^3 over the unit ball
  const std::size_t n = position.size();
  return particle_field(FieldParticles{.position = position,
                                       .velocity = std::vector<Vec3>(n, Vec3::Zero()),
                                       .sigma = std::vector<double>(n, sigma),
                                       .weight = std::vector<double>(n, 1.0),
                                       .weight_rate = std::vector<double>(n, 0.0)},
                        kernels, 0.5 * kKernelIntegral * sigma * sigma * sigma, 0);
}

/// How a surface lies.
struct Lie {
  double height = 0;   ///< waviness [sigma]
  double normals = 0;  ///< [degrees]
  double place = 0;    ///< volume of the ball, or height of the plane, over that of the particles
};

Lie lie_of(const Waviness& waviness, double sigma, double place) {
  return {waviness.height / sigma, waviness.normals, place};
}

/// Means of what is measured on several surfaces: of squares where they are RMS.
Lie together(std::span<const Lie> of) {
  Lie mean;
  const double share = 1 / static_cast<double>(of.size());
  for (const Lie& lie : of) {
    mean.height += share * lie.height * lie.height;
    mean.normals += share * lie.normals * lie.normals;
    mean.place += share * lie.place;
  }
  return {std::sqrt(mean.height), std::sqrt(mean.normals), mean.place};
}

Lie of_ball(const KernelsOptions& o, Kernels kernels) {
  constexpr int kRays = 4000;
  std::vector<Vec3> ball = lattice_box(Vec3::Constant(std::floor(o.ball) + 0.5));
  std::erase_if(ball, [&](const Vec3& x) { return x.norm() > o.ball; });
  const std::vector<Vec3> from(kRays, Vec3::Zero()), rays = fibonacci_sphere(kRays, Vec3(1, 2, 3), 0);
  const Waviness found = waviness(*field_of(ball, o.sigma, kernels), from, rays, o.ball + 2);
  double volume = 0;
  for (const double r : found.distances) volume += 4 * std::numbers::pi / 3 * r * r * r / kRays;
  return lie_of(found, o.sigma, volume / static_cast<double>(ball.size()));
}

/// One way of shaking.
Lie of_plane(const KernelsOptions& o, Kernels kernels, unsigned seed) {
  constexpr double kHalf = 17, kDepth = 3, kMeasured = 6;  // [spacings]
  constexpr int kRays = 2000;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> along(-1, 1);
  const auto vector = [&] {
    const double x = along(random), y = along(random), z = along(random);
    return Vec3(x, y, z);
  };
  std::vector<Vec3> slab = lattice_box(Vec3(kHalf, kHalf, kDepth)), from;
  for (Vec3& x : slab) x += o.shaken * vector();
  for (int i = 0; i < kRays; ++i) from.push_back(kMeasured * vector().cwiseProduct(Vec3(1, 1, 0)));
  const Waviness found =
      waviness(*field_of(slab, o.sigma, kernels), from, std::vector<Vec3>(kRays, Vec3::UnitZ()), kDepth + 2);
  double height = 0;
  for (const double z : found.distances) height += z / kRays;
  return lie_of(found, o.sigma, height / (kDepth + 0.5));
}

Lie of_planes(const KernelsOptions& o, Kernels kernels) {
  constexpr unsigned kSeeds = 6;
  std::vector<Lie> planes;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) planes.push_back(of_plane(o, kernels, seed));
  return together(planes);
}

/// Of liquid at rest in a basin, its middle.
Lie of_pool(const KernelsOptions& o, const Particles& pool, Kernels kernels) {
  constexpr int kRays = 3000;
  constexpr double kMargin = 0.3;  // of the basin's edge
  const auto& basin = std::get<BasinShape>(o.pool.walls.front().shape);
  const Vec3 size = basin.upper - basin.lower;
  ParticleFieldOptions options{.sigma = o.sigma * o.pool.fluid.spacing, .kernels = kernels};
  options.threshold =
      half_median_threshold(pool.position, std::vector<double>(pool.size(), 1.0), options.sigma);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> along(kMargin, 1 - kMargin);
  const auto& block = std::get<BoxShape>(o.pool.blocks.front().shape);
  const Vec3 filled = block.upper - block.lower;
  const double level = filled.prod() / (size.x() * size.z());
  std::vector<Vec3> from;
  for (int i = 0; i < kRays; ++i) {
    const double x = along(random), z = along(random);
    from.emplace_back(basin.lower + Vec3(x * size.x(), 0.5 * level, z * size.z()));
  }
  const Waviness found = waviness_of_graph(*particle_field(pool, options), from, 0, 2, Vec3::UnitY(), level);
  double height = 0;
  for (const double y : found.distances) height += (y + 0.5 * level) / kRays;
  return lie_of(found, options.sigma, height / level);
}

/// Thickness of a sheet of so many layers over that of its particles; 0 where it has no surface.
double sheet(const KernelsOptions& o, Kernels kernels, double layers) {
  constexpr double kHalf = 16;
  const auto field = field_of(lattice_box(Vec3(kHalf, kHalf, 0.5 * (layers - 1))), o.sigma, kernels);
  return 2 * crossing(*field, Vec3(0.5, 0.3, 0), Vec3::UnitZ(), layers + 2).distance / layers;
}

/// Radius of a thread of single particles over that of their volume.
double thread(const KernelsOptions& o, Kernels kernels) {
  const auto field = field_of(lattice_box(Vec3(0, 0, 20)), o.sigma, kernels);
  return crossing(*field, Vec3(0, 0, 0.25), Vec3::UnitX(), 3).distance * std::sqrt(std::numbers::pi);
}

/// A number for either kind of kernels, in the order of kKernels.
using OfKernels = std::array<double, std::size(kKernels)>;

template <class Measure>
OfKernels of_both(const Measure& measure) {
  OfKernels result{};
  for (std::size_t k = 0; k < result.size(); ++k) result[k] = measure(kKernels[k].value);
  return result;
}

struct Measured {
  std::string what;
  OfKernels of;
};

struct StillResults {
  std::vector<Measured> waviness;  // heights and normals
  std::vector<Measured> place;     // over what it should be
};

StillResults still_results(const KernelsOptions& o) {
  StillResults results;
  const auto add = [&](const std::string& body, const std::string& place, const auto& measure) {
    std::array<Lie, std::size(kKernels)> of;
    for (std::size_t k = 0; k < of.size(); ++k) of[k] = measure(o, kKernels[k].value);
    results.waviness.push_back({fmt::format("{}: height [sigma]", body), {of[0].height, of[1].height}});
    results.waviness.push_back({fmt::format("{}: normals [degrees]", body), {of[0].normals, of[1].normals}});
    results.place.push_back({fmt::format("{}: {}", body, place), {of[0].place, of[1].place}});
  };
  add("ball", "volume", of_ball);
  add("plane", "height", of_planes);
  FluidSolver liquid = make_liquid(o.pool);
  advance(liquid, o.pool.duration);
  add("pool", "level", [&](const KernelsOptions& options, Kernels kernels) {
    return of_pool(options, liquid.particles(), kernels);
  });
  for (const double layers : o.layers)
    results.place.push_back({fmt::format("sheet of {} particles: thickness", layers),
                             of_both([&](Kernels kernels) { return sheet(o, kernels, layers); })});
  results.place.push_back(
      {"thread of one particle: radius", of_both([&](Kernels kernels) { return thread(o, kernels); })});
  return results;
}

/// Slips of a method on a frame.
struct FlowResult {
  std::string frame, method;
  OfKernels slip, slip_near;  // of the whole surface, and of what is near that of round kernels
};

/// 1 for vertices that are near the surface of `field`.
std::vector<char> near_surface(const TriangleMesh& mesh, const Field& field) {
  constexpr double kNear = 0.1;  // [sigma]
  std::vector<char> is_near(mesh.vertex_count());
  parallel_for(mesh.vertex_count(), [&](std::size_t v) {
    const ValueAndGradient at = field.value_and_gradient(mesh.position[v]);
    is_near[v] = std::abs(at.f) < kNear * field.length_scale() * at.g.norm();
  });
  return is_near;
}

std::vector<FlowResult> flow_results(const KernelsOptions& o, const ExperimentContext& context) {
  std::vector<FlowResult> results;
  for (const std::string& file : o.frames) {
    context.say(file);
    const FieldParticles particles = read_particle_file(context.file.parent_path() / file);
    const double threshold =
        half_median_threshold(particles.position, particles.weight, particles.sigma.front());
    const std::size_t first = results.size();
    for (const VelocityMethod& method : velocity_methods())
      results.push_back({std::filesystem::path(file).stem().string(), std::string(method.name), {}, {}});
    const auto round = particle_field(particles, Kernels::round, threshold, 0);
    for (std::size_t k = 0; k < std::size(kKernels); ++k) {
      const auto field = particle_field(particles, kKernels[k].value, threshold, 0);
      const TriangleMesh mesh = initial_mesh(*field, o.edge_length, {});
      const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
      const std::vector<char> is_near = near_surface(mesh, *round);
      for (std::size_t m = 0; m < velocity_methods().size(); ++m) {
        SurfaceState state = surface_state(*field, mesh, rings, velocity_methods()[m].evaluate, o.velocity);
        results[first + m].slip[k] = slip(state).value_or(std::nan(""));
        for (std::size_t v = 0; v < is_near.size(); ++v)
          if (!is_near[v]) state.area[v] = 0;
        results[first + m].slip_near[k] = slip(state).value_or(std::nan(""));
      }
    }
  }
  return results;
}

Table still_table(const std::vector<Measured>& rows, const std::string& caption, const char* format) {
  Table table{caption, {"", "round", "anisotropic"}, {}};
  for (const Measured& row : rows)
    table.rows.push_back({row.what, fmt::format(fmt::runtime(format), row.of[0]),
                          fmt::format(fmt::runtime(format), row.of[1])});
  return table;
}

Table flow_table(const std::vector<FlowResult>& results) {
  Table table{"Slip against the moving-least-squares velocity of the particles, by kernels.",
              {"frame", "method", "round", "anisotropic", "anisotropic, near the surface of round ones"},
              {}};
  for (const FlowResult& r : results)
    table.rows.push_back({r.frame, r.method, fmt::format("{:.3f}", r.slip[0]),
                          fmt::format("{:.3f}", r.slip[1]), fmt::format("{:.3f}", r.slip_near[1])});
  return table;
}

void judge(const StillResults& still, const std::vector<FlowResult>& flow, Report& report) {
  std::vector<Check> smooth, place, followed;
  for (const Measured& m : still.waviness) {
    smooth.push_back(at_most(m.what, m.of[1], m.of[0] / kSmoother, "a fifth of round kernels'"));
  }
  for (const Measured& m : still.place) {
    const bool is_thin = m.what.starts_with("sheet") || m.what.starts_with("thread");
    place.push_back(at_most(m.what + " error", std::abs(m.of[1] - 1), is_thin ? kThinError : kVolumeError));
  }
  for (const FlowResult& r : flow)
    if (r.method == "regional")
      followed.push_back(
          at_most(r.frame, r.slip_near[1], kSlipShare * r.slip[0], "that of round kernels and 5 %"));
  report.statements = {judged(kIsSmooth, smooth), judged(kKeepsVolume, place), judged(kIsFollowed, followed)};
}

std::string csv(const StillResults& still, const std::vector<FlowResult>& flow) {
  std::string text = "case,round,anisotropic\n";
  for (const auto* rows : {&still.waviness, &still.place})
    for (const Measured& m : *rows) text += fmt::format("{},{:.8g},{:.8g}\n", m.what, m.of[0], m.of[1]);
  for (const FlowResult& r : flow) {
    text += fmt::format("slip of {} on {},{:.8g},{:.8g}\n", r.method, r.frame, r.slip[0], r.slip[1]);
    text += fmt::format("near slip of {} on {},{:.8g},{:.8g}\n", r.method, r.frame, r.slip_near[0],
                        r.slip_near[1]);
  }
  return text;
}

}  // namespace

Report experiment_kernels(const ExperimentContext& context) {
  const KernelsOptions options = read_options(context, context.options.quick);
  context.say("particles at rest");
  const StillResults still = still_results(options);
  const std::vector<FlowResult> flow = flow_results(options, context);
  write_file(context.folder / "kernels.csv", csv(still, flow));

  Report report;
  report.name = context.name;
  report.title = options.title;
  report.introduction = fmt::format(
      "Particles of a lattice, and liquid at rest, sigma {} spacings, threshold half the interior value; "
      "and {} frames of a viscous flow on a staircase that another simulator made (sigma 2 spacings).",
      options.sigma, options.frames.size());
  const KernelsOptions whole = read_options(context, false);
  add_smaller(report, "particle spacing of the pool", fmt::format("{} m", options.pool.fluid.spacing),
              fmt::format("{} m", whole.pool.fluid.spacing));
  add_smaller(report, "frames of the flow", fmt::format("{}", options.frames.size()),
              fmt::format("{}", whole.frames.size()));
  judge(still, flow, report);
  report.tables = {
      still_table(still.waviness, "Waviness: RMS distance from the smooth surface, and of the normals.",
                  "{:.4f}"),
      still_table(still.place, "Where the surface lies, over where the particles' volume puts it.", "{:.3f}"),
      flow_table(flow)};
  std::vector<Plot> plots{{"Frames of a real flow", "frame", "slip", {}}};
  for (const char* method : {"curvature", "regional"})
    for (std::size_t k = 0; k < std::size(kKernels); ++k) {
      Curve curve{.title = fmt::format("{}, {}", method, kKernels[k].name), .points = {}};
      for (const FlowResult& r : flow)
        if (r.method == method)
          curve.points.emplace_back(static_cast<double>(curve.points.size() + 1), r.slip[k]);
      plots.front().curves.push_back(std::move(curve));
    }
  add_plots(report, context, "kernels", plots, "Slip on the frames, in their order, by kernels.");
  report.files = {"kernels.csv"};
  return report;
}

}  // namespace kappaflow
