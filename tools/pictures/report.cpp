#include "tools/pictures/report.h"

#include <cmark-gfm-core-extensions.h>
#include <cmark-gfm.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <memory>
#include <span>
#include <tuple>

#include "tools/io/files.h"

namespace kappaflow {
namespace {

constexpr const char* kStyle =
    "body{font:16px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#222}"
    "table{border-collapse:collapse;margin:1em 0}th,td{border:1px solid #ccc;padding:.3em .6em;"
    "text-align:left;vertical-align:top}th{background:#f3f3f3}img{max-width:100%}code{background:#f3f3f3}";

constexpr const char* kStatements = "Statements beside what was measured";

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

std::string heading(const Report& report) {
  return fmt::format("{}: {}", report.name, report.title);
}

/// What GitHub makes of a heading to link to it, and the HTML has as well.
std::string anchor(const std::string& heading) {
  std::string result;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || c == '-' || c == '_') result += static_cast<char>(std::tolower(byte));
    if (c == ' ') result += '-';
  }
  return result;
}

std::string link_to(const Report& report, const std::string& text) {
  return fmt::format("[{}](#{})", text, anchor(heading(report)));
}

/// "3 hold, 1 does not hold": those that there are.
std::string tally(const std::vector<const Statement*>& statements) {
  std::string text;
  for (const auto& [verdict, one, many] :
       {std::tuple{Verdict::holds, "holds", "hold"},
        std::tuple{Verdict::under_conditions, "holds under conditions", "hold under conditions"},
        std::tuple{Verdict::does_not_hold, "does not hold", "do not hold"},
        std::tuple{Verdict::too_coarse, "is too coarse to tell", "are too coarse to tell"}}) {
    const auto count = std::ranges::count(statements, verdict, &Statement::verdict);
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, count == 1 ? one : many);
  }
  return text.empty() ? "none" : text;
}

std::vector<const Statement*> statements_of(std::span<const Report> reports) {
  std::vector<const Statement*> statements;
  for (const Report& report : reports)
    for (const Statement& statement : report.statements) statements.push_back(&statement);
  return statements;
}

std::string head_markdown(const ReportHead& head, const std::vector<Report>& reports) {
  const std::vector<const Statement*> all = statements_of(reports);
  std::string text =
      fmt::format("# {}\n\n**{} statement{}: {}.**\n\n{}, {}: `{}`\n\n## Contents\n\n", head.title,
                  all.size(), all.size() == 1 ? "" : "s", tally(all), head.program, head.date, head.command);
  text += fmt::format("- [{}](#{})\n", kStatements, anchor(kStatements));
  for (const Report& report : reports)
    text += fmt::format("- {}: {}\n", link_to(report, heading(report)), tally(statements_of({&report, 1})));
  return text + "\n";
}

std::string statement_table(const std::vector<Report>& reports) {
  Table table{"", {"", "Statement", "Source", "Measured", "Verdict", "Why, and when"}, {}};
  for (const Report& report : reports) {
    const std::string smaller = report.smaller.empty() ? "" : fmt::format("*Quick: {}.* ", report.smaller);
    for (const Statement& s : report.statements)
      table.rows.push_back({link_to(report, report.name), s.statement, s.source, smaller + s.measured,
                            fmt::format("**{}**", verdict_text(s.verdict)), s.reason});
  }
  return fmt::format("## {}\n\n", kStatements) + table_markdown(table);
}

std::string chapter_markdown(const Report& report) {
  std::string text = fmt::format("## {}\n\n{}\n\n", heading(report), report.introduction);
  if (!report.smaller.empty()) text += fmt::format("*Quick: {}.*\n\n", report.smaller);
  for (const Figure& figure : report.figures)
    text += fmt::format("![{0}]({1})\n\n*{0}*\n\n", figure.caption, figure.file);
  for (const Table& table : report.tables) text += table_markdown(table);
  if (!report.files.empty()) text += "Files:";
  for (std::size_t f = 0; f < report.files.size(); ++f)
    text += fmt::format("{}[{}]({})", f == 0 ? " " : ", ", report.files[f], report.files[f]);
  return text + fmt::format("{}Wall time: {:.1f} s.\n\n", report.files.empty() ? "" : ". ", report.seconds);
}

std::string report_markdown(const ReportHead& head, const std::vector<Report>& reports) {
  std::string text = head_markdown(head, reports) + statement_table(reports);
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

/// Gives each heading of the contents and the chapters the name that links go to.
std::string with_anchors(std::string body, const std::vector<Report>& reports) {
  std::vector<std::string> anchors{"contents", anchor(kStatements)};
  for (const Report& report : reports) anchors.push_back(anchor(heading(report)));
  std::size_t at = 0;
  for (const std::string& name : anchors) {
    at = body.find("<h2>", at);
    body.replace(at, 4, fmt::format("<h2 id=\"{}\">", name));
  }
  return body;
}

}  // namespace

Statement judged(const Claim& claim, std::string measured, const std::vector<Check>& checks) {
  std::string yes, no;
  for (const Check& check : checks) {
    std::string& list = check.holds ? yes : no;
    list += fmt::format("{}{}", list.empty() ? "" : ", ", check.what);
  }
  if (measured.ends_with("; ")) measured.resize(measured.size() - 2);  // of a list
  const auto holds = [](const Check& check) { return check.holds; };
  const Verdict verdict = std::ranges::all_of(checks, holds)    ? Verdict::holds
                          : std::ranges::none_of(checks, holds) ? Verdict::does_not_hold
                                                                : Verdict::under_conditions;
  const std::string conditions =
      verdict == Verdict::under_conditions ? fmt::format(" Holds for: {}. Not for: {}.", yes, no) : "";
  return {claim.source, claim.statement, std::move(measured), verdict, claim.reason + conditions};
}

std::string verdict_text(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds:
      return "holds";
    case Verdict::under_conditions:
      return "holds under conditions";
    case Verdict::too_coarse:
      return "too coarse to tell";
    default:
      return "does not hold";
  }
}

void write_report(const std::filesystem::path& folder, const ReportHead& head,
                  const std::vector<Report>& reports) {
  const std::string markdown = report_markdown(head, reports);
  write_file(folder / "report.md", markdown);
  write_file(folder / "report.html",
             fmt::format("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{}</title>"
                         "<style>{}</style></head>\n<body>\n{}</body></html>\n",
                         head.title, kStyle, with_anchors(html_body(markdown), reports)));
}

}  // namespace kappaflow
