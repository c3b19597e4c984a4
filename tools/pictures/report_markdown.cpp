#include <fmt/format.h>

#include <cctype>

#include "tools/pictures/report_formats.h"
#include "tools/pictures/report_parts.h"

namespace kappaflow {
namespace {

std::string cell(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '|') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

std::string row_markdown(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& text : cells) row += fmt::format(" {} |", cell(text));
  return row + "\n";
}

std::string table_markdown(const Table& table) {
  std::string text = table.caption.empty() ? "" : table.caption + "\n\n";
  text += row_markdown(table.header) + "|";
  for (std::size_t c = 0; c < table.header.size(); ++c) text += "---|";
  text += "\n";
  for (const auto& row : table.rows) text += row_markdown(row);
  return text + "\n";
}

/// What GitHub makes of a heading to link to it.
std::string anchor(const std::string& heading) {
  std::string result;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || c == '-' || c == '_') result += static_cast<char>(std::tolower(byte));
    if (c == ' ') result += '-';
  }
  return result;
}

std::string heading_link(const std::string& text, const std::string& to_heading) {
  return fmt::format("[{}](#{})", text, anchor(to_heading));
}

/// Of a statement in its chapter.
std::string statement_heading(const Report& report, std::size_t s) {
  return fmt::format("{}: {}", number_of(report, s), verdict_text(report.statements[s].verdict));
}

std::string head_markdown(const ReportHead& head, const std::vector<Report>& reports) {
  std::string text = fmt::format("# {}\n\n**{}.**\n\n", head.title, tally(statements_of(reports)));
  if (const std::string quick = quick_text(reports); !quick.empty()) text += quick + "\n\n";
  text += fmt::format("{}, {}: `{}`\n\n## {}\n\n", head.program, head.date, head.command, kContents);
  text += fmt::format("- {}\n", heading_link(kStatements, kStatements));
  for (const Report& report : reports)
    text += fmt::format("- {}: {}{}\n", heading_link(heading(report), heading(report)),
                        tally(statements_of({report})), report.smaller.empty() ? "" : " (quick)");
  return text + "\n";
}

std::string statements_markdown(const std::vector<Report>& reports) {
  Table table{"", kStatementHeader, {}};
  for (const Report& report : reports)
    for (std::size_t s = 0; s < report.statements.size(); ++s) {
      auto& row =
          table.rows.emplace_back(1, heading_link(number_of(report, s), statement_heading(report, s)));
      for (std::string& cell : statement_cells(report.statements[s])) row.push_back(std::move(cell));
    }
  return fmt::format("## {}\n\n{}", kStatements, table_markdown(table));
}

std::string statement_markdown(const Report& report, std::size_t s) {
  const Statement& statement = report.statements[s];
  return fmt::format("### {}\n\n**{}** ({}) {}\n\n{}\n\n", statement_heading(report, s), statement.statement,
                     statement.source, heading_link("All statements", kStatements), statement.reason) +
         table_markdown(check_table(statement));
}

std::string figure_markdown(const Figure& figure) {
  std::string text = fmt::format("![{0}]({1})\n\n*{0}*", figure.caption, figure.file);
  if (figure.kind != Figure::Kind::picture)
    text += fmt::format(" [PDF]({}), [SVG]({}), [gnuplot]({})", in_format(figure, "pdf"),
                        in_format(figure, "svg"), in_format(figure, "gp"));
  return text + "\n\n";
}

std::string chapter_markdown(const Report& report) {
  std::string text = fmt::format("## {}\n\n{}\n\n", heading(report), report.introduction);
  if (!report.smaller.empty()) text += fmt::format("*Quick: {}.*\n\n", report.smaller);
  if (!report.beside.rows.empty()) text += table_markdown(report.beside);
  for (std::size_t s = 0; s < report.statements.size(); ++s) text += statement_markdown(report, s);
  for (const Figure& figure : report.figures) text += figure_markdown(figure);
  for (const Table& table : report.tables) text += table_markdown(table);
  if (!report.files.empty()) text += "Files:";
  for (std::size_t f = 0; f < report.files.size(); ++f)
    text += fmt::format("{}[{}]({})", f == 0 ? " " : ", ", report.files[f], report.files[f]);
  return text + fmt::format("{}Wall time: {:.1f} s.\n\n", report.files.empty() ? "" : ". ", report.seconds);
}

}  // namespace

std::string report_markdown(const ReportHead& head, const std::vector<Report>& reports) {
  std::string text = head_markdown(head, reports) + statements_markdown(reports);
  for (const Report& report : reports) text += chapter_markdown(report);
  return text;
}

}  // namespace kappaflow
