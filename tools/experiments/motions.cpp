#include "tools/experiments/motions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/toml_reader.h"
#include "surface/field/particle_weights.h"
#include "surface/measure/surface_state.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/motion/velocity_methods.h"
#include "surface/remesh/initial_mesh.h"
#include "tools/io/files.h"
#include "tools/io/particle_file.h"
#include "tools/pictures/method_curve.h"

namespace kappaflow {
namespace {

// Limits.
constexpr double kRigidError = 1e-3;   // relative; rounding and the small damping leave less than 1e-5
constexpr double kStrainError = 0.14;  // relative; what the normal velocity leaves under strain
constexpr double kSlipShare = 0.25;    // of Eq. 10's slip

// What is claimed.

const Claim kFollowsRotation{
    "Fujisawa et al. 2011", "Curvature invariance (Eq. 10) follows a rotation better than total velocity.",
    "The rows of total velocity contradict a rotation; Eq. 10 is a compromise between the two."};
const Claim kRigidIsExact{
    "kappaflow", "The regional velocity reproduces every rigid motion.",
    "Relative RMS error. Its rows hold exactly for every affine motion of the particles."};
const Claim kStrainIsClose{
    "kappaflow", "Under strain the regional velocity is off by at most 0.14.",
    "Relative RMS error. Along the surface it is exact; what is left is the normal velocity (Eq. 4), "
    "which all methods share: the kernels "
    "of the particles stay round while the material is strained."};
const Claim kFlowIsFollowed{
    "kappaflow", "On a real flow the regional velocity slips at most a quarter as much as Eq. 10.",
    "Slip against the material. Where the motion is affine over a window it is followed."};

struct AffineMotion {
  std::string name;
  Vec3 u;
  Mat3 G;
  Vec3 at(const Vec3& x) const { return u + G * x; }
};

std::vector<AffineMotion> affine_motions() {
  Mat3 rotation, shear, stretch;
  rotation << 0, -1, 0, 1, 0, 0, 0, 0, 0;
  shear << 0, 1, 0, 0, 0, 0, 0, 0, 0;
  stretch << 1, 0, 0, 0, -0.5, 0, 0, 0, -0.5;
  return {{"translation", Vec3(1, 0, 0), Mat3::Zero()},
          {"rotation", Vec3::Zero(), rotation},
          {"shear", Vec3::Zero(), shear},
          {"stretch", Vec3::Zero(), stretch}};
}

struct MotionOptions {
  std::string title;
  std::filesystem::path body;
  std::vector<std::string> frames;
  double body_edge = 0, flow_edge = 0;
  VelocityOptions body_velocity, flow_velocity;
};

void read_velocity(TomlTable& t, double& edge_length, VelocityOptions& velocity) {
  edge_length = t.number("edge_length", positive("m", 100));
  velocity.damping = t.number("damping", positive("", 1e3));
  velocity.speed_limit = t.number("speed_limit", positive("", 1e3));
}

MotionOptions motion_options(const ExperimentContext& context, bool quick_variant) {
  const toml::table document = read_toml(context.file);
  TomlTable root(document, "the experiment", context.file.string());
  MotionOptions o;
  o.title = root.text("title");
  TomlTable body = root.table("body", true), flow = root.table("flow", true), quick = root.table("quick");
  root.finish();
  o.body = body.text("file");
  read_velocity(body, o.body_edge, o.body_velocity);
  body.finish();
  o.frames = flow.texts("files");
  read_velocity(flow, o.flow_edge, o.flow_velocity);
  flow.finish();
  const int quick_frames = quick.integer("frames", 1, static_cast<int>(o.frames.size()), 1);
  quick.finish();
  if (quick_variant) o.frames.resize(quick_frames);
  return o;
}

/// A row a method, a column a motion or a frame.
struct Errors {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> of_method;  // in the order of velocity_methods()

  double of(std::string_view method, std::size_t column) const {
    const auto methods = velocity_methods();
    const auto found = std::ranges::find(methods, method, &VelocityMethod::name);
    return of_method.at(static_cast<std::size_t>(found - methods.begin())).at(column);
  }
};

ParticleField field_of(const FieldParticles& particles) {
  return {particles, half_median_threshold(particles.position, particles.weight, particles.sigma.front()), 0};
}

/// Area-weighted RMS error of the velocity over the RMS true velocity.
Errors body_errors(const MotionOptions& options, const std::filesystem::path& folder) {
  FieldParticles particles = read_particle_file(folder / options.body);
  const TriangleMesh mesh = initial_mesh(field_of(particles), options.body_edge, {.tolerance = 1e-10});
  const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
  Errors errors{{}, std::vector<std::vector<double>>(velocity_methods().size())};
  for (const AffineMotion& motion : affine_motions()) {
    errors.columns.push_back(motion.name);
    std::ranges::transform(particles.position, particles.velocity.begin(),
                           [&](const Vec3& x) { return motion.at(x); });
    const ParticleField field = field_of(particles);
    for (std::size_t m = 0; m < velocity_methods().size(); ++m) {
      const SurfaceState state =
          surface_state(field, mesh, rings, velocity_methods()[m].evaluate, options.body_velocity);
      double error = 0, size = 0;
      for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
        const Vec3 truth = motion.at(mesh.position[v]);
        error += state.area[v] * (state.motion.velocity[v] - truth).squaredNorm();
        size += state.area[v] * truth.squaredNorm();
      }
      errors.of_method[m].push_back(std::sqrt(error / size));
    }
  }
  return errors;
}

/// Slip against the material velocity, see slip().
Errors flow_slips(const MotionOptions& options, const std::filesystem::path& folder,
                  const ExperimentContext& context) {
  Errors errors{{}, std::vector<std::vector<double>>(velocity_methods().size())};
  for (const std::string& file : options.frames) {
    context.say(file);
    const ParticleField field = field_of(read_particle_file(folder / file));
    const TriangleMesh mesh = initial_mesh(field, options.flow_edge, {});
    const VertexRings rings = vertex_rings(mesh.vertex_count(), mesh.triangles);
    errors.columns.push_back(std::filesystem::path(file).stem().string());
    for (std::size_t m = 0; m < velocity_methods().size(); ++m)
      errors.of_method[m].push_back(
          slip(surface_state(field, mesh, rings, velocity_methods()[m].evaluate, options.flow_velocity))
              .value_or(std::nan("")));
  }
  return errors;
}

Table error_table(const Errors& errors, const std::string& caption) {
  Table table{caption, {"method"}, {}};
  table.header.insert(table.header.end(), errors.columns.begin(), errors.columns.end());
  for (std::size_t m = 0; m < velocity_methods().size(); ++m) {
    auto& row = table.rows.emplace_back(1, std::string(velocity_methods()[m].name));
    for (const double error : errors.of_method[m]) row.push_back(fmt::format("{:.3f}", error));
  }
  return table;
}

std::string csv(const Errors& body, const Errors& flow) {
  std::string text = "method,case,error\n";
  for (const Errors* errors : {&body, &flow})
    for (std::size_t m = 0; m < velocity_methods().size(); ++m)
      for (std::size_t c = 0; c < errors->columns.size(); ++c)
        text += fmt::format("{},{},{:.8g}\n", velocity_methods()[m].name, errors->columns[c],
                            errors->of_method[m][c]);
  return text;
}

Statement judge_rotation(const Errors& body) {
  constexpr std::size_t kRotation = 1;
  const double total = body.of("total", kRotation), curvature = body.of("curvature", kRotation);
  return judged(kFollowsRotation, {at_most("relative error of Eq. 10", curvature, total, "total's")});
}

/// The regional velocity in the motions from number `first` to before `last`.
Statement judge_motions(const Claim& claim, const Errors& body, std::size_t first, std::size_t last,
                        double limit) {
  std::vector<Check> checks;
  checks.reserve(last - first);
  for (std::size_t c = first; c < last; ++c)
    checks.push_back(at_most(body.columns[c], body.of("regional", c), limit));
  return judged(claim, checks);
}

Statement judge_flow(const Errors& flow) {
  std::vector<Check> checks;
  checks.reserve(flow.columns.size());
  for (std::size_t c = 0; c < flow.columns.size(); ++c)
    checks.push_back(at_most(flow.columns[c], flow.of("regional", c), kSlipShare * flow.of("curvature", c),
                             "a quarter of Eq. 10's"));
  return judged(kFlowIsFollowed, checks);
}

void judge(const Errors& body, const Errors& flow, Report& report) {
  constexpr std::size_t kFirstStrain = 2;  // after translation and rotation
  report.statements = {judge_rotation(body), judge_motions(kRigidIsExact, body, 0, kFirstStrain, kRigidError),
                       judge_motions(kStrainIsClose, body, kFirstStrain, body.columns.size(), kStrainError),
                       judge_flow(flow)};
}

}  // namespace

Report experiment_motions(const ExperimentContext& context) {
  const MotionOptions options = motion_options(context, context.options.quick);
  const std::filesystem::path folder = context.file.parent_path();
  const Errors body = body_errors(options, folder), flow = flow_slips(options, folder, context);
  write_file(context.folder / "motions.csv", csv(body, flow));

  Report report;
  report.name = context.name;
  report.title = options.title;
  report.introduction = fmt::format(
      "A body of 175 jittered particles (sigma two spacings, threshold half the interior value) in four "
      "affine motions (damping {}, speed limit {}), and {} frames of a viscous flow on a staircase that "
      "another simulator made (damping {}, speed limit {}).",
      options.body_velocity.damping, options.body_velocity.speed_limit, options.frames.size(),
      options.flow_velocity.damping, options.flow_velocity.speed_limit);
  add_smaller(report, "frames of the flow", fmt::format("{}", options.frames.size()),
              fmt::format("{}", motion_options(context, false).frames.size()));
  judge(body, flow, report);
  std::vector<Plot> plots{{"Frames of a real flow", "frame", "slip", {}}};
  for (std::size_t m = 0; m < velocity_methods().size(); ++m) {
    Curve curve = method_curve(velocity_methods()[m].name);
    for (std::size_t c = 0; c < flow.columns.size(); ++c)
      curve.points.emplace_back(static_cast<double>(c + 1), flow.of_method[m][c]);
    plots.front().curves.push_back(std::move(curve));
  }
  add_plots(report, context, "motions", plots, "Slip of every method on the frames, in their order.");
  report.tables = {
      error_table(body, "Known motions: area-weighted RMS error over the RMS velocity."),
      error_table(flow, "Real flow: slip against the moving-least-squares velocity of the particles.")};
  report.files = {"motions.csv"};
  return report;
}

}  // namespace kappaflow
