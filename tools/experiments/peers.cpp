#include "tools/experiments/peers.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/errors.h"
#include "scenes/toml_reader.h"

namespace kappaflow {
namespace {

/// Calls read(table) with the file's table and reports what it left.
template <class Read>
void read_peers(const ExperimentContext& context, const char* name, const Read& read) {
  const std::filesystem::path file = context.file.parent_path() / "data" / name;
  const toml::table document = read_toml(file);
  TomlTable table(document, "the figures", file.string());
  read(table);
  table.finish();
}

Table table_of(const ExperimentContext& context, const char* name) {
  Table table;
  read_peers(context, name, [&](TomlTable& t) {
    table.caption = t.text("caption");
    table.header = t.texts("columns");
    for (TomlTable& program : t.tables("program", true)) {
      table.rows.push_back(program.texts("cells"));
      if (table.rows.back().size() != table.header.size())
        program.refuse("cells", fmt::format("{} texts, one a column", table.header.size()));
      program.finish();
    }
  });
  return table;
}

}  // namespace

MeasuredFronts measured_fronts(const ExperimentContext& context) {
  MeasuredFronts fronts;
  read_peers(context, "martin_moyce_1952.toml", [&](TomlTable& t) {
    fronts.name = t.text("name");
    fronts.figure = t.text("figure");
    const std::vector<double> time = t.numbers("T", positive(""), {}),
                              front = t.numbers("Z", positive(""), {});
    if (time.size() < 2 || !std::ranges::is_sorted(time)) t.refuse("T", "two or more times in their order");
    if (front.size() != time.size()) t.refuse("Z", fmt::format("a front for each of {} times", time.size()));
    for (std::size_t i = 0; i < time.size(); ++i) fronts.points.emplace_back(time[i], front[i]);
  });
  return fronts;
}

MeasuredOutlines measured_outlines(const ExperimentContext& context) {
  MeasuredOutlines measured;
  read_peers(context, "lister_1992.toml", [&](TomlTable& t) {
    measured.name = t.text("name");
    measured.figure = t.text("figure");
    for (TomlTable& outline : t.tables("outline", true)) {
      MeasuredOutlines::Outline& to = measured.outlines.emplace_back();
      to.time = outline.number("time", positive("s"));
      const std::vector<double> x = outline.numbers("x", NumberRange{.unit = "m"}, {}),
                                y = outline.numbers("y", non_negative("m"), {});
      if (y.size() != x.size()) outline.refuse("y", fmt::format("a number for each of {} of x", x.size()));
      for (std::size_t i = 0; i < x.size(); ++i) to.points.emplace_back(x[i], y[i]);
      outline.finish();
    }
    if (!std::ranges::is_sorted(measured.outlines, {}, &MeasuredOutlines::Outline::time))
      t.refuse("outline", "outlines in the order of their times");
  });
  return measured;
}

PaperFigures paper_figures(const ExperimentContext& context) {
  PaperFigures figures;
  read_peers(context, "fujisawa_2011.toml", [&](TomlTable& t) {
    figures.source = t.text("source");
    figures.faired_error = t.number("faired_error", positive("body size"));
    figures.total_after_30_turns = t.number("total_after_30_turns", positive("body size"));
  });
  return figures;
}

Table enright_programs(const ExperimentContext& context) {
  return table_of(context, "enright_programs.toml");
}

Table level_set_papers(const ExperimentContext& context) {
  return table_of(context, "level_set_papers.toml");
}

}  // namespace kappaflow
