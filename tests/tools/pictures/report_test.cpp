#include "tools/pictures/report.h"

#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

TEST(Judged, TheVerdictFollowsFromTheChecks) {
  const auto verdict = [](const std::vector<Check>& checks) {
    return judged({"a paper", "a claim", "Because."}, "a number", checks);
  };
  EXPECT_EQ(verdict({{"one", true}, {"two", true}}).verdict, Verdict::holds);
  EXPECT_EQ(verdict({{"one", false}}).verdict, Verdict::does_not_hold);
  EXPECT_EQ(verdict({{"", false}}).verdict, Verdict::does_not_hold) << "a single check needs no name";
  EXPECT_EQ(verdict({{"one", false}}).reason, "Because.");
  const Statement mixed = verdict({{"one", true}, {"two", false}, {"three", true}});
  EXPECT_EQ(mixed.verdict, Verdict::under_conditions);
  EXPECT_EQ(mixed.reason, "Because. Holds for: one, three. Not for: two.");
}

class WrittenReport : public Scratch {};

TEST_F(WrittenReport, HasStatementsTablesAndPicturesInBothForms) {
  Report report;
  report.name = "fig0";
  report.title = "A test";
  report.introduction = "What was *done*.";
  report.statements.push_back(judged({"a|b", "x < y", "Because."}, "3", {{"", true}}));
  report.tables.push_back({"A caption.", {"method", "error"}, {{"total", "0.5"}}});
  report.figures.push_back({"fig0/a.png", "A picture"});
  report.files = {"fig0/a.csv"};
  write_report(folder, {"Title", "kappaflow 1.2", "kappaflow experiment fig0", "2026-01-02T03:04:05Z"},
               {report});

  const std::string markdown = bytes_of(folder / "report.md"), html = bytes_of(folder / "report.html");
  EXPECT_NE(markdown.find("| [fig0](#fig0-a-test) | x < y | a\\|b | 3 | **holds** | Because. |"),
            std::string::npos)
      << markdown;
  EXPECT_NE(markdown.find("![A picture](fig0/a.png)"), std::string::npos);
  for (const char* part :
       {"<h2 id=\"fig0-a-test\">fig0: A test</h2>", "<em>done</em>", "<td>x &lt; y</td>", "<td>a|b</td>",
        "<strong>holds</strong>", "<td>total</td>", "<img src=\"fig0/a.png\"", "<a href=\"fig0/a.csv\">"})
    EXPECT_NE(html.find(part), std::string::npos) << part << "\n" << html;
}

TEST_F(WrittenReport, OpensWithATallyTheCommandAndLinksToTheChapters) {
  const auto statement = [](Verdict verdict) {
    return Statement{"a paper", "a claim", "3", verdict, "Because."};
  };
  Report one, two;
  one.name = "fig0";
  one.title = "One, two & three";
  two.name = "fig-1";
  two.title = "Another";
  one.statements = {statement(Verdict::holds), statement(Verdict::does_not_hold), statement(Verdict::holds)};
  two.statements = {statement(Verdict::under_conditions), statement(Verdict::too_coarse)};
  two.smaller = "turns 1 instead of 3";
  write_report(folder, {"Title", "kappaflow 1.2", "kappaflow experiment fig0 fig-1", "2026-01-02T03:04:05Z"},
               {one, two});
  const std::string markdown = bytes_of(folder / "report.md"), html = bytes_of(folder / "report.html");
  EXPECT_TRUE(markdown.starts_with(
      "# Title\n\n**5 statements: 2 hold, 1 holds under conditions, 1 does not hold, 1 is too coarse to "
      "tell.**\n\n"
      "kappaflow 1.2, 2026-01-02T03:04:05Z: `kappaflow experiment fig0 fig-1`\n\n## Contents\n\n"))
      << markdown;
  EXPECT_NE(markdown.find("- [fig0: One, two & three](#fig0-one-two--three): 2 hold, 1 does not hold\n"),
            std::string::npos)
      << markdown;
  EXPECT_NE(markdown.find("| *Quick: turns 1 instead of 3.* 3 | **too coarse to tell** |"), std::string::npos)
      << markdown;
  // Every link within the page goes somewhere.
  std::size_t links = 0;
  for (std::size_t at = 0; (at = html.find("href=\"#", at)) != std::string::npos; ++at, ++links) {
    const std::string name = html.substr(at + 7, html.find('"', at + 7) - at - 7);
    EXPECT_NE(html.find("<h2 id=\"" + name + "\">"), std::string::npos) << name << "\n" << html;
  }
  EXPECT_EQ(links, 3u + 5u) << "the contents, and each statement's experiment";
}

}  // namespace
}  // namespace kappaflow
