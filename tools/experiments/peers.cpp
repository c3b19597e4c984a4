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
