#include "tools/pictures/report_parts.h"

#include <fmt/format.h>

#include <algorithm>

namespace kappaflow {

std::vector<const Statement*> statements_of(const std::vector<Report>& reports) {
  std::vector<const Statement*> statements;
  for (const Report& report : reports)
    for (const Statement& statement : report.statements) statements.push_back(&statement);
  return statements;
}

std::string heading(const Report& report) {
  return fmt::format("{}: {}", report.name, report.title);
}

std::string number_of(const Report& report, std::size_t statement) {
  return fmt::format("{}.{}", report.name, statement + 1);
}

std::string quick_text(const std::vector<Report>& reports) {
  const auto smaller = [](const Report& report) { return !report.smaller.empty(); };
  if (std::ranges::none_of(reports, smaller)) return {};
  return "**Quick run.** These are smaller variants, which show that all works; the numbers are not those of "
         "the whole experiments. What is smaller stands in each chapter.";
}

std::vector<std::string> statement_cells(const Statement& s) {
  const Check& check = s.decisive();
  const std::string of = check.what.empty() ? "" : fmt::format(" ({})", check.what);
  return {s.statement,
          s.source,
          check.value_text() + of,
          check.limit_text(),
          fmt::format("{} of {}", s.cases_that_hold(), s.checks.size()),
          fmt::format("**{}**", verdict_text(s.verdict))};
}

Table check_table(const Statement& statement) {
  Table table{"", {"Case", "Measured", "Limit", "Within"}, {}};
  for (const Check& check : statement.checks)
    table.rows.push_back(
        {check.what, check.value_text(), check.limit_text(), check.holds() ? "yes" : "**no**"});
  return table;
}

std::string in_format(const Figure& plot, const std::string& format) {
  return plot.file.substr(0, plot.file.rfind('.') + 1) + format;
}

}  // namespace kappaflow
