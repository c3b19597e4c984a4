#include "tools/experiments/paper_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numbers>

#include "core/parallel.h"
#include "scenes/toml_reader.h"
#include "surface/motion/total.h"

namespace kappaflow {
namespace {

constexpr int kMostTurns = 10000;

/// Reads the choices that a table names. Of the others: the values that a wider table has, or the default.
class ChoiceReader {
 public:
  ChoiceReader(TomlTable& table, const std::vector<PaperChoice>& otherwise)
      : table_(table), otherwise_(otherwise) {}

  void numbers(const char* key, const NumberRange& range, double& (*member)(PaperSetting&)) {
    PaperSetting standard;
    add(
        key, [&] { return table_.numbers(key, range, {member(standard)}); }, member, range.unit);
  }
  void integers(const char* key, int least, int& (*member)(PaperSetting&)) {
    PaperSetting standard;
    add(
        key, [&] { return table_.integers(key, least, kMostTurns, {member(standard)}); }, member);
  }
  template <class T, std::size_t N>
  void names(const char* key, const Named<T> (&table)[N], T& (*member)(PaperSetting&)) {
    const auto read = [&] {
      PaperSetting standard;
      std::vector<std::string_view> allowed;
      for (const Named<T>& named : table) allowed.push_back(named.name);
      return table_.names(key, allowed, {std::string(name_of(table, member(standard)))});
    };
    add(key, read, [&table, member](PaperSetting& s) { return Choose<T, N>{table, member(s)}; });
  }
  std::vector<PaperChoice> choices() { return std::move(choices_); }

 private:
  template <class T, std::size_t N>
  struct Choose {
    const Named<T> (&table)[N];
    T& target;
    void operator=(const std::string& name) const { target = *value_of(table, name); }
  };

  template <class Read, class Member>
  void add(const char* key, const Read& read, const Member& member, std::string_view unit = {}) {
    if (!table_.has(key) && !otherwise_.empty()) {
      choices_.push_back(otherwise_[choices_.size()]);
      return;
    }
    const auto values = read();
    if (values.empty()) table_.refuse(key, "one or more values");
    const std::string label = unit.empty() ? key : fmt::format("{} [{}]", key, unit);
    PaperChoice choice{
        key, label, {}, [values, member](std::size_t k, PaperSetting& s) { member(s) = values[k]; }};
    for (const auto& value : values) choice.values.push_back(fmt::format("{}", value));
    choices_.push_back(std::move(choice));
  }

  TomlTable& table_;
  const std::vector<PaperChoice>& otherwise_;
  std::vector<PaperChoice> choices_;
};

std::vector<PaperChoice> read_choices(TomlTable& t, const std::vector<PaperChoice>& otherwise) {
  using S = PaperSetting;
  ChoiceReader reader(t, otherwise);
  reader.numbers("sigma", positive("m", 1e6), [](S& s) -> double& { return s.sigma; });
  reader.numbers("radius", positive("sigma", 100), [](S& s) -> double& { return s.radius; });
  reader.numbers("threshold", positive("", 1), [](S& s) -> double& { return s.threshold; });
  reader.numbers("edge_length", {0.02, 1, false, "sigma"}, [](S& s) -> double& { return s.edge_length; });
  reader.integers("steps_per_turn", 3, [](S& s) -> int& { return s.steps_per_turn; });
  reader.names(
      "integrator", kIntegrators, +[](S& s) -> TimeIntegrator& { return s.integrator; });
  reader.integers("fairing_iterations", 0, [](S& s) -> int& { return s.fairing_iterations; });
  reader.names(
      "fairing_moves", kFairedVertices, +[](S& s) -> FairedVertices& { return s.fairing_moves; });
  reader.numbers("fairing_relaxation", positive("", 1), [](S& s) -> double& { return s.fairing_relaxation; });
  reader.numbers("damping", non_negative("", 1e3), [](S& s) -> double& { return s.damping; });
  reader.names(
      "minimiser", kMinimisers, +[](S& s) -> Minimiser& { return s.search.minimiser; });
  reader.names(
      "start", kSearchStarts, +[](S& s) -> SearchStart& { return s.search.start; });
  reader.numbers("tolerance", non_negative("", 1), [](S& s) -> double& { return s.search.tolerance; });
  return reader.choices();
}

std::size_t map_axis(TomlTable& t, const char* key, const std::vector<PaperChoice>& choices) {
  std::vector<std::string_view> keys;
  keys.reserve(choices.size());
  for (const PaperChoice& choice : choices) keys.push_back(choice.key);
  const std::string name = t.text(key);
  const auto found = std::ranges::find(keys, name);
  if (found != keys.end()) return static_cast<std::size_t>(found - keys.begin());
  if (t.has(key)) t.refuse(key, fmt::format("{}", fmt::join(keys, ", ")));
  return 0;  // it is missing, which finish() reports
}

/// All combinations, the last choice fastest.
void combine_choices(PaperMap& map) {
  std::vector<std::size_t> place(map.choices.size(), 0);
  for (bool more = true; more;) {
    PaperResult result{place, {}, {}, {}};
    for (std::size_t c = 0; c < place.size(); ++c) map.choices[c].set(place[c], result.setting);
    map.results.push_back(std::move(result));
    more = false;
    for (std::size_t c = place.size(); c-- > 0 && !more;) {
      more = ++place[c] < map.choices[c].values.size();
      if (!more) place[c] = 0;
    }
  }
}

PaperMap read_map(TomlTable t, const std::vector<PaperChoice>& otherwise, bool quick) {
  PaperMap map;
  map.name = t.text("name");
  map.title = t.text("title");
  map.choices = read_choices(t, otherwise);
  TomlTable fewer = t.table("quick");
  const std::vector<PaperChoice> quick_choices = read_choices(fewer, map.choices);
  fewer.finish();
  if (quick) map.choices = quick_choices;
  map.x = map_axis(t, "x", map.choices);
  map.y = map_axis(t, "y", map.choices);
  t.finish();
  combine_choices(map);
  return map;
}

PaperSweep read_sweep(TomlTable t, const char* name, int particles, const TrackerOptions& tracker,
                      bool quick) {
  PaperSweep sweep;
  sweep.name = name;
  sweep.particles = particles;
  sweep.tracker = tracker;
  sweep.turns = t.integer("turns", 1, kMostTurns);
  const int quick_turns = t.integer("quick_turns", 1, kMostTurns, sweep.turns);
  if (quick) sweep.turns = quick_turns;
  sweep.choices = read_choices(t, {});
  for (TomlTable& map : t.tables("map", true))
    sweep.maps.push_back(read_map(std::move(map), sweep.choices, quick));
  t.finish();
  return sweep;
}

/// The setting as what the experiments with rigid bodies take. Where there is one particle, it is on the
/// circle as well.
RigidExperiment rigid_experiment(const PaperSweep& sweep, const PaperSetting& s) {
  RigidExperiment experiment;
  experiment.motion.angular_velocity = Vec3(0, 0, 2 * std::numbers::pi);
  experiment.cycles = sweep.turns;
  experiment.steps_per_cycle = s.steps_per_turn;
  experiment.tracker = sweep.tracker;
  experiment.tracker.velocity.row_scale = RowScale::metre;
  experiment.tracker.velocity.damping = s.damping / (s.sigma * s.sigma);
  experiment.tracker.fairing.moves = s.fairing_moves;
  experiment.tracker.fairing.relaxation = s.fairing_relaxation;
  TrackedBody body{fmt::format("{} on a circle of {} sigma", sweep.particles, s.radius),
                   {},
                   s.threshold,
                   s.edge_length * s.sigma};
  for (int p = 0; p < sweep.particles; ++p) {
    const double angle = 2 * std::numbers::pi * p / sweep.particles;
    body.particles.position.push_back(s.radius * s.sigma * Vec3(std::cos(angle), std::sin(angle), 0));
    body.particles.sigma.push_back(s.sigma);
    body.particles.weight.push_back(1);
    body.particles.weight_rate.push_back(0);
  }
  experiment.bodies.push_back(std::move(body));
  return experiment;
}

PaperErrors errors_of(const PaperSweep& sweep, const PaperSetting& s, const VelocityFunction& velocity,
                      const std::string& file) {
  const RigidExperiment experiment = rigid_experiment(sweep, s);
  const TrackedBody& body = experiment.bodies.front();
  RigidCase c{&body, "", s.integrator, s.fairing_iterations, 0, {}, {}};
  run_rigid_case(experiment, start_mesh(experiment, body, file), velocity, c);
  PaperErrors errors;
  for (int turn = 1; turn <= sweep.turns; ++turn)
    errors.after_turn.push_back(c.end_error(turn, s.steps_per_turn));
  errors.over_run = c.mean_over_run();
  errors.unprojected = c.samples.back().unprojected;
  return errors;
}

/// What total velocity knows of a setting.
PaperSetting without_search(PaperSetting s) {
  s.sigma = 1;
  s.damping = PaperSetting{}.damping;
  s.search = {};
  return s;
}

std::string key_of_total(const PaperSetting& s) {
  return fmt::format("{} {} {} {} {} {} {} {}", s.radius, s.threshold, s.edge_length, s.steps_per_turn,
                     name_of(kIntegrators, s.integrator), s.fairing_iterations,
                     name_of(kFairedVertices, s.fairing_moves), s.fairing_relaxation);
}

}  // namespace

std::vector<PaperSweep> read_paper_sweeps(const std::filesystem::path& file, bool quick) {
  const toml::table document = read_toml(file);
  TomlTable root(document, "the experiment", file.string());
  TomlTable tracking = root.table("tracking", true);
  TrackerOptions tracker;
  tracker.velocity.speed_limit = tracking.number("speed_limit", positive("", 1e3));
  tracker.projection.tolerance = tracking.number("projection_tolerance", positive("sigma", 0.01));
  tracker.fairing.rest_length_time = tracking.number("rest_length_time", positive("s", 1e9), 1e9);
  tracking.finish();
  std::vector<PaperSweep> sweeps;
  sweeps.push_back(read_sweep(root.table("three", true), "three", 3, tracker, quick));
  sweeps.push_back(read_sweep(root.table("one", true), "one", 1, tracker, quick));
  root.finish();
  return sweeps;
}

std::string sweeps_text(const std::vector<PaperSweep>& sweeps) {
  std::vector<std::string> texts;
  for (const PaperSweep& sweep : sweeps) {
    std::vector<std::string> choices;
    for (const PaperChoice& choice : sweep.choices)
      choices.push_back(fmt::format("{} {}", choice.key, fmt::join(choice.values, ", ")));
    texts.push_back(fmt::format("{} particle{}, {} turns: {}", sweep.name, sweep.particles == 1 ? "" : "s",
                                sweep.turns, fmt::join(choices, ", ")));
  }
  return fmt::format("{}", fmt::join(texts, "; "));
}

void run_paper_sweep(PaperSweep& sweep, const ExperimentContext& context) {
  struct Run {
    PaperSetting setting;
    VelocityFunction velocity;
    PaperErrors errors;
  };
  std::vector<Run> runs;
  std::map<std::string, std::size_t> of_total;
  std::vector<PaperResult*> results;
  for (PaperMap& map : sweep.maps)
    for (PaperResult& result : map.results) results.push_back(&result);
  runs.reserve(2 * results.size());
  for (const PaperResult* result : results)
    runs.push_back({result->setting, searched_curvature(result->setting.search), {}});
  for (const PaperResult* result : results) {
    const PaperSetting setting = without_search(result->setting);
    if (of_total.emplace(key_of_total(setting), runs.size()).second)
      runs.push_back({setting, evaluate_total, {}});
  }
  context.say(
      fmt::format("{} particle{}, {} runs", sweep.particles, sweep.particles == 1 ? "" : "s", runs.size()));
  parallel_for(
      runs.size(),
      [&](std::size_t r) {
        runs[r].errors = errors_of(sweep, runs[r].setting, runs[r].velocity, context.file.string());
      },
      1);
  for (std::size_t r = 0; r < results.size(); ++r) {
    results[r]->curvature = runs[r].errors;
    results[r]->total = runs[of_total.at(key_of_total(without_search(results[r]->setting)))].errors;
  }
}

}  // namespace kappaflow
