#include "tools/report.h"

#include <cmark-gfm-core-extensions.h>
#include <cmark-gfm.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

#include "tools/files.h"

namespace kappaflow {
namespace {

constexpr const char* kStyle =
    "body{font:16px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0}th,td{border:1px solid #ccc;padding:.3em .6em;"
    "text-align:left;vertical-align:top}th{background:#f3f3f3}img{max-width:100%}code{background:#f3f3f3}";

std::string cell(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '|') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

std::string table_row(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& text : cells) row += fmt::format(" {} |", cell(text));
  return row + "\n";
}

std::string table_markdown(const Table& table) {
  std::string text = table.caption.empty() ? "" : table.caption + "\n\n";
  text += table_row(table.header) + "|";
  for (std::size_t c = 0; c < table.header.size(); ++c) text += "---|";
  text += "\n";
  for (const auto& row : table.rows) text += table_row(row);
  return text + "\n";
}

Table statement_table(const std::vector<Report>& reports, const std::string& caption) {
  Table table{caption, {"", "Statement", "Source", "Measured", "Verdict", "Why, and when"}, {}};
  for (const Report& report : reports)
    for (const Statement& s : report.statements)
      table.rows.push_back({report.name, s.statement, s.source, s.measured,
                            fmt::format("**{}**", verdict_text(s.verdict)), s.reason});
  return table;
}

std::string chapter_markdown(const Report& report) {
  std::string text = fmt::format("## {}: {}\n\n{}\n\n", report.name, report.title, report.introduction);
  for (const Figure& figure : report.figures)
    text += fmt::format("![{0}]({1})\n\n*{0}*\n\n", figure.caption, figure.file);
  for (const Table& table : report.tables) text += table_markdown(table);
  if (!report.files.empty()) text += "Files:";
  for (std::size_t f = 0; f < report.files.size(); ++f)
    text += fmt::format("{}[{}]({})", f == 0 ? " " : ", ", report.files[f], report.files[f]);
  return text + fmt::format("{}Wall time: {:.1f} s.\n\n", report.files.empty() ? "" : ". ", report.seconds);
}

std::string report_markdown(const std::string& title, const std::vector<Report>& reports) {
  std::string text = fmt::format("# {}\n\n", title);
  text +=
      table_markdown(statement_table(reports, "Statements beside what was measured; the chapters follow."));
  for (const Report& report : reports) text += chapter_markdown(report);
  return text;
}

struct FreeNode {
  void operator()(cmark_node* node) const { cmark_node_free(node); }
};
struct FreeParser {
  void operator()(cmark_parser* parser) const { cmark_parser_free(parser); }
};

std::string html_body(const std::string& markdown) {
  cmark_gfm_core_extensions_ensure_registered();
  const std::unique_ptr<cmark_parser, FreeParser> parser(cmark_parser_new(CMARK_OPT_DEFAULT));
  cmark_parser_attach_syntax_extension(parser.get(), cmark_find_syntax_extension("table"));
  cmark_parser_feed(parser.get(), markdown.data(), markdown.size());
  const std::unique_ptr<cmark_node, FreeNode> document(cmark_parser_finish(parser.get()));
  char* rendered =
      cmark_render_html(document.get(), CMARK_OPT_DEFAULT, cmark_parser_get_syntax_extensions(parser.get()));
  std::string body(rendered);
  std::free(rendered);
  return body;
}

}  // namespace

Statement judged(std::string source, std::string statement, std::string measured,
                 const std::vector<Check>& checks, const std::string& why) {
  std::string yes, no;
  for (const Check& check : checks) {
    std::string& list = check.holds ? yes : no;
    list += fmt::format("{}{}", list.empty() ? "" : ", ", check.what);
  }
  const auto holds = [](const Check& check) { return check.holds; };
  const Verdict verdict = std::ranges::all_of(checks, holds)    ? Verdict::holds
                          : std::ranges::none_of(checks, holds) ? Verdict::does_not_hold
                                                                : Verdict::under_conditions;
  const std::string conditions =
      verdict == Verdict::under_conditions ? fmt::format(" Holds for: {}. Not for: {}.", yes, no) : "";
  return {std::move(source), std::move(statement), std::move(measured), verdict, why + conditions};
}

std::string verdict_text(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds:
      return "holds";
    case Verdict::under_conditions:
      return "holds under conditions";
    default:
      return "does not hold";
  }
}

void write_report(const std::filesystem::path& folder, const std::string& title,
                  const std::vector<Report>& reports) {
  const std::string markdown = report_markdown(title, reports);
  write_file(folder / "report.md", markdown);
  write_file(folder / "report.html",
             fmt::format("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{}</title>"
                         "<style>{}</style></head>\n<body>\n{}</body></html>\n",
                         title, kStyle, html_body(markdown)));
}

}  // namespace kappaflow
