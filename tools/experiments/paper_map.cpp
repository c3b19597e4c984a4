#include "tools/experiments/paper_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "tools/experiments/paper_sweep.h"
#include "tools/experiments/peers.h"
#include "tools/io/files.h"
#include "tools/pictures/cell_map.h"

namespace kappaflow {
namespace {

// Limits; errors are in body sizes.
constexpr double kClearlyBelow = 0.9;  // of total's error: what differs by less is one curve in a plot
constexpr double kFollows = 0.5;       // of total's error over the run
constexpr double kAbout = 2;           // times the paper's number, or that part of it
constexpr double kHalfFrom = 0.4, kHalfTo = 0.6;  // of the error at the end, after half of the turns: linear
constexpr double kHardly = 0.25;                  // of total's error

/// Something that was printed, and whether it comes out in a setting. The first two of a number of particles
/// colour its maps.
struct Printed {
  std::string short_name;
  Claim claim;
  std::function<bool(const PaperResult&)> holds;
};
using PrintedThings = std::vector<Printed>;

// What is claimed.

PrintedThings printed_of_three(const PaperFigures& paper) {
  const double limit = paper.faired_error;
  const std::string source = paper.source + ", Figs. 4 and 5";
  const auto small = [limit](const PaperResult& r) {
    return std::max(r.total.end(), r.curvature.end()) < limit;
  };
  const auto below = [](const PaperResult& r) { return r.curvature.end() <= kClearlyBelow * r.total.end(); };
  const std::string how =
      "Settings in which it holds; errors are mean distances to the start, after whole turns. ";
  return {
      {fmt::format("both below {}", limit),
       {source, fmt::format("The errors of total and of curvature after the turns are below {}.", limit),
        how + "Total velocity keeps each vertex at its normal: a body that is nearly a sphere brings it "
              "back. On "
              "others a mesh slides, and fairing moves its vertices on, unless it holds the whole mesh."},
       small},
      {"curvature below total",
       {source, "Curvature's error after the turns is below total's (by a tenth at least).",
        how + "Total velocity is back by itself where the body is convex, so that curvature can be below it "
              "only where it is not."},
       below},
      {"",
       {source, "Both: errors as small as the paper's, and curvature's below total's.",
        how +
            "The surface must be deep in the field (a high threshold), where all particles are in reach and "
            "the curvatures see the turn, and waisted: springs at their rest lengths then keep a mesh that "
            "is "
            "coarse, or faired often, in the shape of the body, and it turns with it, by either method."},
       [=](const PaperResult& r) { return small(r) && below(r); }},
      {"",
       {paper.source + ", section 4",
        "Over the whole run curvature is off by less than half of what total is.",
        "Settings in which it holds; distances to the true trajectory. The smaller the world, the more the "
        "rows "
        "of curvature weigh in the plain sum of squares."},
       [](const PaperResult& r) { return r.curvature.over_run < kFollows * r.total.over_run; }}};
}

PrintedThings printed_of_one(const PaperFigures& paper) {
  const double about = paper.total_after_30_turns;
  const std::string source = paper.source + ", Fig. 8";
  return {
      {fmt::format("total linear, to about {}", about),
       {source, fmt::format("Total's error grows linearly with the turns, to about {}.", about),
        "Settings in which it holds; mean distance to the start. It is the error of the integration: each "
        "step "
        "of Euler's method is off by the same vector in the frame that turns, which turns the mesh on its "
        "sphere by the same angle in every turn. With N steps a turn on a circle of radius R a sphere of "
        "radius "
        "r is off by pi^4 R^2/(4 N^2 r (R + r)) more after each."},
       [about](const PaperResult& r) {
         const std::vector<double>& errors = r.total.after_turn;
         const double end = r.total.end(), half = errors[(errors.size() + 1) / 2 - 1];
         return end >= about / kAbout && end <= kAbout * about && half >= kHalfFrom * end &&
                half <= kHalfTo * end;
       }},
      {"curvature hardly grows",
       {source, "Curvature's error hardly grows: to a quarter of total's at most.",
        "Settings in which it holds. On a sphere K and H are constant: their rows are empty whatever the "
        "unit "
        "of length, and the least sum of squares is total's. A search that stops short leaves out a share e "
        "of "
        "the way from its start. From rest that adds e v dt across the step's own error, v w dt^2/2 at the "
        "angular velocity w; from the last velocity it makes that 1 + 2 e times as large. Neither is less."},
       [](const PaperResult& r) { return r.curvature.end() <= kHardly * r.total.end(); }}};
}

// What came out.

/// "fairing_iterations 10, fairing_moves all": the values of those choices that neither axis shows.
std::string panel_name(const PaperMap& map, const PaperResult& r) {
  std::vector<std::string> parts;
  for (std::size_t c = 0; c < map.choices.size(); ++c)
    if (c != map.x && c != map.y && map.choices[c].values.size() > 1)
      parts.push_back(fmt::format("{} {}", map.choices[c].key, map.choices[c].values[r.place[c]]));
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// Two digits where they fit into a cell.
std::string cell_text(double error) {
  return error >= 0.01 ? fmt::format("{:.2g}", error) : fmt::format("{:.0e}", error);
}

std::vector<CellMap> cell_maps(const PaperMap& map, const PrintedThings& printed) {
  const PaperChoice &x = map.choices[map.x], &y = map.choices[map.y];
  std::vector<CellMap> panels;
  for (const PaperResult& r : map.results) {
    const std::string name = panel_name(map, r);
    auto panel = std::ranges::find(panels, name, &CellMap::title);
    if (panel == panels.end()) {
      panels.push_back({name, x.label, y.label, x.values, y.values, {}});
      panel = panels.end() - 1;
      panel->cells.resize(x.values.size() * y.values.size());
    }
    const std::size_t kind = (printed[0].holds(r) ? 1 : 0) + (printed[1].holds(r) ? 2 : 0);
    panel->cells[r.place[map.y] * x.values.size() + r.place[map.x]] = {kind, cell_text(r.total.end()),
                                                                       cell_text(r.curvature.end())};
  }
  return panels;
}

/// "radius 0.1, 1; start zero": of the choices that matter the values with which it holds somewhere.
std::string conditions(const PaperSweep& sweep, const Printed& printed) {
  std::vector<std::string> texts;
  for (std::size_t c = 0; c < sweep.maps.front().choices.size(); ++c) {
    std::vector<std::string> all, with;
    const auto add = [](std::vector<std::string>& values, const std::string& value) {
      if (std::ranges::count(values, value) == 0) values.push_back(value);
    };
    for (const PaperMap& map : sweep.maps)
      for (const PaperResult& r : map.results) {
        const std::string& value = map.choices[c].values[r.place[c]];
        add(all, value);
        if (printed.holds(r)) add(with, value);
      }
    if (with.size() < all.size())
      texts.push_back(fmt::format("{} {}", sweep.maps.front().choices[c].key, fmt::join(with, ", ")));
  }
  return fmt::format("{}", fmt::join(texts, "; "));
}

/// A check a map: in how many of its settings it holds, beside how many there are.
Statement judge_map(const PaperSweep& sweep, const Printed& printed) {
  std::vector<Check> checks;
  double in_all = 0, settings = 0;
  for (const PaperMap& map : sweep.maps) {
    const auto all = static_cast<double>(map.results.size());
    const auto holding = static_cast<double>(std::ranges::count_if(map.results, printed.holds));
    checks.push_back(at_least(map.title, holding, all, "all"));
    in_all += holding, settings += all;
  }
  Statement statement = judged(printed.claim, checks);
  if (in_all > 0 && in_all < settings) {
    statement.verdict = Verdict::under_conditions;
    statement.reason += fmt::format(" It holds in {:.0f} of {:.0f} settings, all of them with: {}.", in_all,
                                    settings, conditions(sweep, printed));
  }
  return statement;
}

std::string map_csv(const std::vector<PaperSweep>& sweeps, const std::vector<PrintedThings>& printed) {
  std::string text = "particles,map";
  for (const PaperChoice& choice : sweeps.front().maps.front().choices) text += "," + choice.key;
  text +=
      ",turns,total_end,curvature_end,total_over_run,curvature_over_run,unprojected,first_holds,second_"
      "holds\n";
  for (std::size_t s = 0; s < sweeps.size(); ++s)
    for (const PaperMap& map : sweeps[s].maps)
      for (const PaperResult& r : map.results) {
        text += fmt::format("{},{}", sweeps[s].particles, map.name);
        for (std::size_t c = 0; c < map.choices.size(); ++c) text += "," + map.choices[c].values[r.place[c]];
        text += fmt::format(",{},{:.6g},{:.6g},{:.6g},{:.6g},{},{:d},{:d}\n", sweeps[s].turns, r.total.end(),
                            r.curvature.end(), r.total.over_run, r.curvature.over_run,
                            r.total.unprojected + r.curvature.unprojected, printed[s][0].holds(r),
                            printed[s][1].holds(r));
      }
  return text;
}

std::size_t settings_of(const std::vector<PaperSweep>& sweeps) {
  std::size_t settings = 0;
  for (const PaperSweep& sweep : sweeps)
    for (const PaperMap& map : sweep.maps) settings += map.results.size();
  return settings;
}

void describe_smaller_maps(const ExperimentContext& context, const std::vector<PaperSweep>& sweeps,
                           Report& report) {
  const std::vector<PaperSweep> whole = read_paper_sweeps(context.file, false);
  const auto count = [](const auto& number) { return fmt::format("{}", number); };
  add_smaller(report, "settings", count(settings_of(sweeps)), count(settings_of(whole)));
  for (std::size_t s = 0; s < sweeps.size(); ++s)
    add_smaller(report, fmt::format("turns of {}", sweeps[s].name), count(sweeps[s].turns),
                count(whole[s].turns));
}

Report first_part(const ExperimentContext& context, const std::vector<PaperSweep>& sweeps) {
  Report report;
  report.name = context.name;
  report.title = "Where the paper's statements on Figs. 4, 5 and 8 hold";
  report.introduction = fmt::format(
      "The paper states neither sizes nor steps. Here are {} settings of what it leaves open. Every cell of "
      "a map "
      "is one of them: above total's error after the turns, below curvature's (Eq. 10), in units of the "
      "body's "
      "size, its largest distance from the axis. The sum of squares of Eq. 10 is the plain one, whose rows "
      "have "
      "different units: sigma [m] is the unit of length, and at 1 m the rows weigh as the method `curvature` "
      "weighs them. Radius: of the circle on which the centres are, in sigma. Tolerance: a search stops "
      "where an "
      "iteration gains no more than this share of the sum, and searches lines to its root; start: where it "
      "begins, at rest, at the vertex' last velocity or at total's. Damping: in units of the row of H; where "
      "fairing moves the *undetermined*, it holds vertices with larger rows. What a map does not vary: {}.",
      settings_of(sweeps), sweeps_text(sweeps));
  return report;
}

}  // namespace

Report experiment_paper_map(const ExperimentContext& context) {
  std::vector<PaperSweep> sweeps = read_paper_sweeps(context.file, context.options.quick);
  const PaperFigures paper = paper_figures(context);
  const std::vector<PrintedThings> printed{printed_of_three(paper), printed_of_one(paper)};
  Report report = first_part(context, sweeps);
  describe_smaller_maps(context, sweeps, report);
  for (std::size_t s = 0; s < sweeps.size(); ++s) {
    run_paper_sweep(sweeps[s], context);
    for (const Printed& thing : printed[s]) report.statements.push_back(judge_map(sweeps[s], thing));
    const std::array<std::string, kMapKinds> kinds{"neither", printed[s][0].short_name,
                                                   printed[s][1].short_name, "both"};
    for (const PaperMap& map : sweeps[s].maps) {
      const std::string name = fmt::format("{}-{}", sweeps[s].name, map.name);
      draw_cell_maps(context.folder, name, kinds, cell_maps(map, printed[s]));
      report.figures.push_back(
          {name + ".png", map.title + ": total's error above, curvature's below.", Figure::Kind::page_plot});
    }
  }
  write_file(context.folder / "paper-map.csv", map_csv(sweeps, printed));
  report.files = {"paper-map.csv"};
  return report;
}

}  // namespace kappaflow
