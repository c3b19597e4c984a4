#include "tools/report.h"

#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

TEST(Judged, TheVerdictFollowsFromTheChecks) {
  const auto verdict = [](const std::vector<Check>& checks) {
    return judged("a paper", "a claim", "a number", checks, "Because.");
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
  report.statements.push_back(judged("a|b", "x < y", "3", {{"", true}}, "Because."));
  report.tables.push_back({"A caption.", {"method", "error"}, {{"total", "0.5"}}});
  report.figures.push_back({"fig0/a.png", "A picture"});
  report.files = {"fig0/a.csv"};
  write_report(folder, "Title", {report});

  const std::string markdown = bytes_of(folder / "report.md"), html = bytes_of(folder / "report.html");
  EXPECT_NE(markdown.find("| fig0 | x < y | a\\|b | 3 | **holds** | Because. |"), std::string::npos)
      << markdown;
  EXPECT_NE(markdown.find("![A picture](fig0/a.png)"), std::string::npos);
  for (const char* part :
       {"<h2>fig0: A test</h2>", "<em>done</em>", "<td>x &lt; y</td>", "<td>a|b</td>",
        "<strong>holds</strong>", "<td>total</td>", "<img src=\"fig0/a.png\"", "<a href=\"fig0/a.csv\">"})
    EXPECT_NE(html.find(part), std::string::npos) << part << "\n" << html;
}

}  // namespace
}  // namespace kappaflow
