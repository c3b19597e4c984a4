#include <cmark-gfm.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

#include "tools/pictures/html_text.h"
#include "tools/pictures/report_formats.h"
#include "tools/pictures/report_parts.h"
#include "tools/pictures/report_style.h"

namespace kappaflow {
namespace {

std::string paragraphs(const std::string& markdown) {
  const std::unique_ptr<char, decltype(&std::free)> rendered(
      cmark_markdown_to_html(markdown.data(), markdown.size(), CMARK_OPT_DEFAULT), &std::free);
  return rendered.get();
}

/// Without the paragraph's marks.
std::string inline_html(const std::string& markdown) {
  if (markdown == "-") return "\u2013";  // alone it would be a list
  std::string html = paragraphs(markdown);
  const std::string_view before = "<p>", after = "</p>\n";
  if (!html.starts_with(before) || !html.ends_with(after)) return html;
  return html.substr(before.size(), html.size() - before.size() - after.size());
}

std::string html_link(const std::string& to, const std::string& text) {
  return fmt::format("<a href=\"{}\">{}</a>", to, text);
}

/// To a place on the page.
std::string link_within(const std::string& place, const std::string& text) {
  return html_link(fmt::format("#{}", place), text);
}

/// Numbers of statements as names of places: "fig3-1", and in the list of all "all-fig3-1".
std::string place_of(const Report& report, std::size_t s) {
  return fmt::format("{}-{}", report.name, s + 1);
}
std::string place_in_list(const Report& report, std::size_t s) {
  return fmt::format("all-{}", place_of(report, s));
}

/// A style for each.
const char* name_of_verdict(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds:
      return "holds";
    case Verdict::under_conditions:
      return "conditions";
    case Verdict::too_coarse:
      return "coarse";
    default:
      return "fails";
  }
}

std::string row_html(const std::vector<std::string>& cells, const char* element) {
  std::string row = "<tr>";
  for (const std::string& cell : cells) row += fmt::format("<{0}>{1}</{0}>", element, inline_html(cell));
  return row + "</tr>\n";
}

std::string table_html(const Table& table, const char* style) {
  std::string text = fmt::format("<div class=\"table\"><table class=\"{}\">\n", style);
  if (!table.caption.empty()) text += fmt::format("<caption>{}</caption>\n", inline_html(table.caption));
  text += fmt::format("<thead>{}</thead>\n<tbody>\n", row_html(table.header, "th"));
  for (const auto& row : table.rows) text += row_html(row, "td");
  return text + "</tbody></table></div>\n";
}

/// As many parts as there are verdicts, as wide as they are many.
std::string tally_bar(const std::vector<const Statement*>& statements) {
  std::string bar = "<p class=\"bar\" aria-hidden=\"true\">";
  for (const Verdict verdict :
       {Verdict::holds, Verdict::under_conditions, Verdict::too_coarse, Verdict::does_not_hold}) {
    const auto count = std::ranges::count(statements, verdict, &Statement::verdict);
    if (count > 0)
      bar += fmt::format("<span class=\"{}\" style=\"flex:{}\">{}</span>", name_of_verdict(verdict), count,
                         count);
  }
  return bar + "</p>\n";
}

std::string contents_html(const std::vector<Report>& reports) {
  std::string text = fmt::format("<nav>\n<h2 id=\"contents\">{}</h2>\n<ul>\n<li>{}</li>\n", kContents,
                                 link_within("statements", kStatements));
  for (const Report& report : reports)
    text +=
        fmt::format("<li>{} <span class=\"aside\">{}{}</span></li>\n",
                    link_within(report.name, inline_html(heading(report))), tally(statements_of({report})),
                    report.smaller.empty() ? "" : " <span class=\"quick\">quick</span>");
  return text + "</ul>\n</nav>\n";
}

std::string head_html(const ReportHead& head, const std::vector<Report>& reports) {
  const std::vector<const Statement*> all = statements_of(reports);
  const std::string quick = quick_text(reports);
  return fmt::format("<header>\n<h1>{}</h1>\n<p class=\"tally\">{}.</p>\n{}{}", html_text(head.title),
                     tally(all), tally_bar(all),
                     quick.empty() ? "" : fmt::format("<div class=\"quick\">{}</div>\n", paragraphs(quick))) +
         fmt::format("<p class=\"aside\">{}, {}: <code>{}</code></p>\n</header>\n", html_text(head.program),
                     html_text(head.date), html_text(head.command)) +
         contents_html(reports);
}

/// A row of the list of all statements is a place that their chapters link back to.
std::string statements_html(const std::vector<Report>& reports) {
  std::string text = fmt::format(
      "<section>\n<h2 id=\"statements\">{}</h2>\n<p>Of several cases the one that decides: the nearest to "
      "its limit, or the furthest beyond it. The numbers lead to all.</p>\n"
      "<div class=\"table\"><table class=\"statements\">\n<thead>",
      kStatements);
  text += row_html(kStatementHeader, "th") + "</thead>\n<tbody>\n";
  for (const Report& report : reports)
    for (std::size_t s = 0; s < report.statements.size(); ++s) {
      text += fmt::format("<tr id=\"{}\" class=\"{}\"><td>{}</td>", place_in_list(report, s),
                          name_of_verdict(report.statements[s].verdict),
                          link_within(place_of(report, s), number_of(report, s)));
      for (const std::string& cell : statement_cells(report.statements[s]))
        text += fmt::format("<td>{}</td>", inline_html(cell));
      text += "</tr>\n";
    }
  return text + "</tbody></table></div>\n</section>\n";
}

std::string statement_html(const Report& report, std::size_t s) {
  const Statement& statement = report.statements[s];
  return fmt::format(
             "<div class=\"statement {}\" id=\"{}\">\n<h3>{} <span class=\"verdict\">{}</span>{}</h3>\n",
             name_of_verdict(statement.verdict), place_of(report, s), number_of(report, s),
             verdict_text(statement.verdict), link_within(place_in_list(report, s), "all statements")) +
         fmt::format("<p><strong>{}</strong> <span class=\"aside\">{}</span></p>\n{}{}</div>\n",
                     inline_html(statement.statement), inline_html(statement.source),
                     table_html(check_table(statement), "checks"), paragraphs(statement.reason));
}

/// A plot as wide as its type is made for, and sharp at any size.
std::string figure_html(const Figure& figure) {
  const bool plot = figure.kind != Figure::Kind::picture;
  const char* style = !plot ? "picture" : figure.kind == Figure::Kind::column_plot ? "column" : "page";
  const std::string formats =
      plot ? fmt::format(" <span class=\"aside formats\">{} {} {} {}</span>",
                         html_link(in_format(figure, "pdf"), "PDF"),
                         html_link(in_format(figure, "svg"), "SVG"), html_link(figure.file, "PNG"),
                         html_link(in_format(figure, "gp"), "gnuplot"))
           : "";
  return fmt::format("<figure>{}<figcaption>{}{}</figcaption></figure>\n",
                     html_link(figure.file, fmt::format("<img class=\"{}\" src=\"{}\" alt=\"{}\">", style,
                                                        plot ? in_format(figure, "svg") : figure.file,
                                                        html_text(figure.caption))),
                     inline_html(figure.caption), formats);
}

std::string chapter_html(const Report& report) {
  std::string text = fmt::format("<section class=\"chapter\">\n<h2 id=\"{}\">{}{}</h2>\n{}", report.name,
                                 inline_html(heading(report)), link_within("contents", "contents"),
                                 paragraphs(report.introduction));
  if (!report.smaller.empty())
    text += fmt::format("<p class=\"quick\">Quick: {}.</p>\n", inline_html(report.smaller));
  if (!report.beside.rows.empty()) text += table_html(report.beside, "beside");
  for (std::size_t s = 0; s < report.statements.size(); ++s) text += statement_html(report, s);
  for (const Figure& figure : report.figures) text += figure_html(figure);
  for (const Table& table : report.tables) text += table_html(table, "numbers");
  text += "<p class=\"aside\">";
  for (const std::string& file : report.files) text += html_link(file, file) + " ";
  return text + fmt::format("Wall time: {:.1f} s.</p>\n</section>\n", report.seconds);
}

}  // namespace

std::string report_html(const ReportHead& head, const std::vector<Report>& reports) {
  std::string text = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" "
      "content=\"width=device-width\">\n<title>{}</title>\n<style>\n{}</style></head>\n"
      "<body>\n{}{}",
      html_text(head.title), kReportStyle, head_html(head, reports), statements_html(reports));
  for (const Report& report : reports) text += chapter_html(report);
  return text + "</body></html>\n";
}

}  // namespace kappaflow
