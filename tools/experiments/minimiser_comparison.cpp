#include "tools/experiments/minimiser_comparison.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/prepared_scene.h"
#include "scenes/toml_reader.h"
#include "surface/motion/curvature_invariance.h"
#include "surface/motion/normal.h"
#include "surface/motion/total.h"
#include "surface/remesh/initial_mesh.h"
#include "tools/experiments/rigid_experiment.h"
#include "tools/experiments/tangential_minimum.h"
#include "tools/io/files.h"
#include "tools/runs/simulation.h"
#include "tools/runs/timings.h"

namespace kappaflow {
namespace {

constexpr double kElsewhere = 1e-3;  // a velocity that differs by more, in units of the fastest particle
constexpr double kWellPosed = 1e-2;  // smaller singular values make a flat valley

// Limits. A minimiser stops at 1e-14 of the sum and is off by its root, 1e-7, times a condition of up to 100
// and some; closed form and minimiser both see the same rows.
constexpr double kFaster = 50;       // times, the closed form than Powell's method
constexpr double kAgreement = 1e-4;  // of the fastest particle's speed

// What is claimed.

const Claim kClosedFormIsFaster{
    "kappaflow",
    "The closed form is at least 50 times faster than Powell's method, at an equal or smaller sum of "
    "squares.",
    "Times faster. The residuals of Eq. 10 are linear in the tangential velocity, so that its minimum is a "
    "linear "
    "least-squares "
    "problem of 4 rows and 2 unknowns. Time of the solution alone; the rows cost all three the same."};
const Claim kMinimisersAgree{
    "kappaflow",
    fmt::format(
        "Where the problem is well posed (smaller singular value above {}) all three agree to 1e-4 of the "
        "fastest particle's speed.",
        kWellPosed),
    "Largest distance from the closed form [speed of the fastest particle]. What looks like wrong local "
    "minima are flat valleys of an ill-conditioned problem: a quadratic function "
    "has one "
    "minimum."};
const Claim kBfgsIsBetter{"Fujisawa et al. 2011", "BFGS is a better choice than Powell's method.",
                          "Mean number of evaluations a vertex, BFGS beside Powell's method."};

struct ProblemOptions {
  std::string title;
  double rigid_damping = 0, flow_damping = 0, flow_time = 0, edge_length = 0;
  int repetitions = 1;
};

ProblemOptions problem_options(const ExperimentContext& context, bool quick_variant) {
  const toml::table document = read_toml(context.file);
  TomlTable root(document, "the experiment", context.file.string());
  ProblemOptions o;
  o.title = root.text("title");
  o.rigid_damping = root.number("rigid_damping", positive("", 1));
  o.flow_damping = root.number("flow_damping", positive("", 1));
  o.flow_time = root.number("flow_time", positive("s", 10));
  o.edge_length = root.number("edge_length", positive("m", 10));
  o.repetitions = root.integer("repetitions", 1, 100000);
  TomlTable quick = root.table("quick");
  root.finish();
  const ProblemOptions full = o;
  o.repetitions = quick.integer("repetitions", 1, 100000, o.repetitions);
  o.edge_length = quick.number("edge_length", positive("m", 10), o.edge_length);
  o.flow_time = quick.number("flow_time", positive("s", 10), o.flow_time);
  quick.finish();
  return quick_variant ? o : full;
}

/// Eq. 10 at the vertices of one mesh.
struct Problem {
  std::string name;
  double damping = 0;
  double speed = 0;  ///< of the fastest particle [m/s]
  std::vector<TangentialRows<4>> rows;
  std::vector<double> singular_value;  ///< the smaller one
  double jet_nanoseconds = 0;          ///< to make the rows of a vertex, its jet included
};

Problem make_problem(const std::string& name, double damping, const Field& field,
                     std::span<const Vec3> points) {
  Problem problem{name, damping, field.fastest_speed(), {}, {}, 0};
  const Stopwatch watch;
  for (const Vec3& x : points) {
    const Jet jet = field.jet(x);
    if (!has_gradient(jet)) continue;
    const TangentBasis basis = tangent_basis(jet.g.normalized());
    const Vec3 v_n = normal_velocity(jet, {});
    const double length = jet.length_scale;
    problem.rows.push_back(
        stacked(total_rows(jet, basis, v_n, length), curvature_rows(jet, basis, v_n, length)));
  }
  problem.jet_nanoseconds = 1e9 * watch.seconds() / static_cast<double>(problem.rows.size());
  for (const TangentialRows<4>& rows : problem.rows)
    problem.singular_value.push_back(
        Eigen::JacobiSVD<Eigen::Matrix<double, 4, 2>>(rows.R).singularValues()[1]);
  return problem;
}

std::vector<Problem> make_problems(const ProblemOptions& options, const ExperimentContext& context) {
  std::vector<Problem> problems;
  const std::filesystem::path folder = context.file.parent_path();
  for (const char* file : {"fig4.toml", "body.toml"}) {
    const RigidExperiment rigid = read_rigid_experiment(folder / file, false);
    for (const TrackedBody& body : rigid.bodies) {
      RigidParticles motion(body.particles, body.threshold, rigid.motion, 0, 1);
      const auto field = motion.at(0);
      const TriangleMesh mesh = initial_mesh(*field, options.edge_length, {});
      problems.push_back(
          make_problem(fmt::format("{} rotating", body.name), options.rigid_damping, *field, mesh.position));
    }
  }
  Scene scene = load_scene(folder.parent_path() / "staircase-small.toml");
  scene.surface.methods = {"curvature"};
  Simulation flow(prepare(scene));
  flow.advance(options.flow_time, [](const FluidStep&) { return true; });
  problems.push_back(
      make_problem("staircase-small", options.flow_damping, flow.field(), flow.surfaces().mesh().position));
  return problems;
}

struct MinimiserResult {
  const Problem* problem;
  Minimiser minimiser;
  double nanoseconds = 0;            ///< a vertex, on one core, the rows given
  double evaluations = 0;            ///< mean
  double difference = 0;             ///< RMS from the closed form, relative to its RMS
  double well_posed_difference = 0;  ///< largest from it where the problem is well posed [fastest particle]
  /// Largest and smallest excess of the damped sum over the closed form's, relative to |b|^2.
  double excess_max = 0, excess_min = 0;
  std::vector<double> elsewhere;  ///< singular values of the vertices where it stops elsewhere
  std::vector<Vec2> distances;    ///< (singular value, distance from the closed form) of every vertex
};

double damped_sum(const TangentialRows<4>& rows, double lambda, const Vec2& y) {
  return (rows.R * y - rows.b).squaredNorm() + lambda * lambda * y.squaredNorm();
}

MinimiserResult solve(const Problem& problem, Minimiser minimiser, int repetitions) {
  MinimiserResult result{&problem, minimiser, 0, 0, 0, 0, 0, 0, {}, {}};
  const std::size_t n = problem.rows.size();
  std::vector<TangentialMinimum> found(n);
  const Stopwatch watch;
  for (int r = 0; r < repetitions; ++r)
    for (std::size_t i = 0; i < n; ++i)
      found[i] = minimise(problem.rows[i], problem.damping, problem.speed, minimiser);
  result.nanoseconds = 1e9 * watch.seconds() / (static_cast<double>(n) * repetitions);
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 closed = solve_damped(problem.rows[i], problem.damping).y;
    const double distance = (found[i].y - closed).norm(), s = problem.singular_value[i];
    difference += distance * distance;
    size += closed.squaredNorm();
    result.evaluations += found[i].evaluations / static_cast<double>(n);
    if (s > kWellPosed)
      result.well_posed_difference = std::max(result.well_posed_difference, distance / problem.speed);
    if (distance > kElsewhere * problem.speed) result.elsewhere.push_back(s);
    const double least = damped_sum(problem.rows[i], problem.damping, closed);
    const double excess = damped_sum(problem.rows[i], problem.damping, found[i].y) - least;
    result.excess_max = std::max(result.excess_max, excess / problem.rows[i].b.squaredNorm());
    result.excess_min = std::min(result.excess_min, excess / problem.rows[i].b.squaredNorm());
    result.distances.emplace_back(s, distance / problem.speed);
  }
  result.difference = std::sqrt(difference / size);
  return result;
}

std::string why(const MinimiserResult& r) {
  if (r.elsewhere.empty()) return "-";
  const auto [low, high] = std::ranges::minmax(r.elsewhere);
  return fmt::format("smaller singular value {:.1g} to {:.1g}", low, high);
}

Table result_table(const std::vector<MinimiserResult>& results) {
  Table table{fmt::format("*Elsewhere*: vertices whose velocity differs from the closed form's by more than "
                          "{} of the fastest particle. Times are of one core, with the rows given; making "
                          "the rows, the jet included, comes on top for each.",
                          kElsewhere),
              {"problem", "minimiser", "vertices", "evaluations", "ns a vertex", "rows, ns a vertex",
               "RMS difference", "largest excess of the sum over the closed form's [sum at rest]",
               "elsewhere", "where"},
              {}};
  for (const MinimiserResult& r : results)
    table.rows.push_back({r.problem->name, std::string(name_of(kMinimisers, r.minimiser)),
                          fmt::format("{}", r.problem->rows.size()), fmt::format("{:.1f}", r.evaluations),
                          fmt::format("{:.0f}", r.nanoseconds),
                          fmt::format("{:.0f}", r.problem->jet_nanoseconds),
                          fmt::format("{:.1e}", r.difference), fmt::format("{:.1e}", r.excess_max),
                          fmt::format("{:.2f} %", 100 * static_cast<double>(r.elsewhere.size()) /
                                                      static_cast<double>(r.problem->rows.size())),
                          why(r)});
  return table;
}

std::string csv(const std::vector<MinimiserResult>& results) {
  std::string text =
      "problem,minimiser,vertices,evaluations,ns_per_vertex,rows_ns_per_vertex,rms_difference,"
      "well_posed_difference_max,excess_max,excess_min,elsewhere_fraction,elsewhere_singular_value_max\n";
  for (const MinimiserResult& r : results)
    text += fmt::format("{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n",
                        r.problem->name, name_of(kMinimisers, r.minimiser), r.problem->rows.size(),
                        r.evaluations, r.nanoseconds, r.problem->jet_nanoseconds, r.difference,
                        r.well_posed_difference, r.excess_max, r.excess_min,
                        static_cast<double>(r.elsewhere.size()) / static_cast<double>(r.problem->rows.size()),
                        r.elsewhere.empty() ? 0 : std::ranges::max(r.elsewhere));
  return text;
}

void judge(const std::vector<MinimiserResult>& results, Report& report) {
  std::vector<Check> faster, agree, fewer;
  for (std::size_t r = 0; r < results.size(); r += 3) {
    const MinimiserResult &closed = results[r], &bfgs = results[r + 1], &powell = results[r + 2];
    const std::string& name = closed.problem->name;
    faster.push_back(at_least(name, powell.nanoseconds / closed.nanoseconds, kFaster));
    agree.push_back(at_most(name + ", Powell", powell.well_posed_difference, kAgreement));
    agree.push_back(at_most(name + ", BFGS", bfgs.well_posed_difference, kAgreement));
    fewer.push_back(at_most(name, bfgs.evaluations, powell.evaluations, "Powell's"));
  }
  report.statements = {judged(kClosedFormIsFaster, faster), judged(kMinimisersAgree, agree),
                       judged(kBfgsIsBetter, fewer)};
}

}  // namespace

Report experiment_minimisers(const ExperimentContext& context) {
  const ProblemOptions options = problem_options(context, context.options.quick);
  const ProblemOptions whole = problem_options(context, false);
  const std::vector<Problem> problems = make_problems(options, context);
  std::vector<MinimiserResult> results;
  std::vector<Plot> plots;
  for (const Problem& problem : problems) {
    context.say(problem.name);
    for (const Minimiser minimiser : {Minimiser::closed_form, Minimiser::bfgs, Minimiser::powell})
      results.push_back(solve(problem, minimiser, options.repetitions));
    Plot plot{problem.name, "smaller singular value", "distance [fastest particle]", {}, true, true};
    for (const MinimiserResult* r : {&results[results.size() - 2], &results.back()})
      plot.curves.push_back({std::string(name_of(kMinimisers, r->minimiser)), r->distances, Look::points});
    plots.push_back(std::move(plot));
  }
  write_file(context.folder / "minimisers.csv", csv(results));

  Report report;
  report.name = context.name;
  report.title = options.title;
  report.introduction = fmt::format(
      "Eq. 10 with the damping of each kind of problem ({} for rotating bodies, {} for the flow), minimised "
      "from rest at every vertex by Powell's method (the paper's), by BFGS (the paper's advice) and in "
      "closed form.",
      options.rigid_damping, options.flow_damping);
  add_smaller(report, "mesh edges of the bodies", fmt::format("{} m", options.edge_length),
              fmt::format("{} m", whole.edge_length));
  add_smaller(report, "flow at", fmt::format("{} s", options.flow_time),
              fmt::format("{} s", whole.flow_time));
  add_smaller(report, "solutions timed", fmt::format("{}", options.repetitions),
              fmt::format("{}", whole.repetitions));
  judge(results, report);
  report.tables = {result_table(results)};
  add_plots(report, context, "minimisers", plots,
            "Where the minimisers stop, as a distance from the closed form, against how well the problem is "
            "posed.");
  report.beside = beside_paper("Section 3", {{"minimiser of Eq. 10", "Powell's method; BFGS would be better",
                                              "the closed form; both of these agree with it"},
                                             {"wrong local minima", "there are some",
                                              "flat valleys: vertices with a small singular value"}});
  report.files = {"minimisers.csv"};
  return report;
}

}  // namespace kappaflow
