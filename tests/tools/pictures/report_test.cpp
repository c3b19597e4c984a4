#include "tools/pictures/report.h"

#include <cmath>
#include <set>

#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

Check passed(const std::string& what) {
  return at_most(what, 1, 2);
}
Check failed(const std::string& what) {
  return at_most(what, 3, 2);
}

TEST(Judged, TheVerdictFollowsFromTheChecks) {
  const auto verdict = [](const std::vector<Check>& checks) {
    return judged({"a paper", "a claim", "Because."}, checks);
  };
  EXPECT_EQ(verdict({passed("one"), passed("two")}).verdict, Verdict::holds);
  EXPECT_EQ(verdict({failed("one")}).verdict, Verdict::does_not_hold);
  EXPECT_EQ(verdict({failed("")}).verdict, Verdict::does_not_hold) << "a single check needs no name";
  EXPECT_EQ(verdict({failed("one")}).reason, "Because.");
  const Statement mixed = verdict({passed("one"), failed("two"), passed("three")});
  EXPECT_EQ(mixed.verdict, Verdict::under_conditions);
  EXPECT_EQ(mixed.reason, "Because.");
  EXPECT_EQ(mixed.cases_that_hold(), 2u) << "one, three, not two";
  EXPECT_EQ(mixed.decisive().what, "two");
}

TEST(Judged, LimitsAreThoseOfTheCheck) {
  EXPECT_TRUE(at_most("", 0.05, 0.05).holds());
  EXPECT_FALSE(at_most("", 0.051, 0.05).holds());
  EXPECT_FALSE(at_most("", std::nan(""), 0.05).holds());
  EXPECT_FALSE(at_least("", std::nan(""), 0.05).holds());
  EXPECT_TRUE(at_least("", 0.9, 0.9).holds());
  EXPECT_EQ(at_most("", 1.0 / 3, 0.05).value_text(), "0.333");
  EXPECT_EQ(at_most("", std::nan(""), 0.05).value_text(), "-");
  EXPECT_EQ(at_most("", 1, 0.05).limit_text(), "≤ 0.05");
  EXPECT_EQ(at_least("", 1, 0.9, "half of total's").limit_text(), "≥ 0.9 (half of total's)");
  const Check between{.what = "", .value = 1.2, .low = 0.9, .high = 1.1};
  EXPECT_EQ(between.limit_text(), "0.9 to 1.1");
  EXPECT_FALSE(between.holds());
}

TEST(Judged, TheNearestToItsLimitDecides) {
  const auto decisive = [](const std::vector<Check>& checks) { return judged({}, checks).decisive().what; };
  EXPECT_EQ(decisive({at_most("far", 1, 10), at_most("near", 0.9, 1), at_most("half", 5, 10)}), "near");
  EXPECT_EQ(decisive({at_most("near", 0.9, 1), at_least("beyond", 0.1, 0.2)}), "beyond");
  EXPECT_EQ(decisive({at_most("beyond", 2, 1), at_most("none", std::nan(""), 1)}), "none");
  EXPECT_EQ(decisive({at_least("negative", -0.2, 0.9), at_most("near", 0.9, 1)}), "negative");
}

class WrittenReport : public Scratch {};

TEST_F(WrittenReport, HasStatementsTablesAndPicturesInBothForms) {
  Report report;
  report.name = "fig0";
  report.title = "A test";
  report.introduction = "What was *done*.";
  report.statements.push_back(judged({"a|b", "x < y", "Because."}, {at_most("", 3, 4)}));
  report.beside = {"", {"Fig. 0", "the paper", "here"}, {{"error", "about 0.06", "0.061"}}};
  report.tables.push_back({"A caption.", {"method", "error"}, {{"total", "0.5"}, {"normal", "-"}}});
  report.figures.push_back({"fig0/a.png", "A picture"});
  report.figures.push_back({"fig0/b.png", "A plot", Figure::Kind::column_plot});
  report.files = {"fig0/a.csv"};
  write_report(folder, {"Title", "kappaflow 1.2", "kappaflow experiment fig0", "2026-01-02T03:04:05Z"},
               {report});

  const std::string markdown = bytes_of(folder / "report.md"), html = bytes_of(folder / "report.html");
  for (const char* part :
       {"| [fig0.1](#fig01-holds) | x < y | a\\|b | 3 | ≤ 4 | 1 of 1 | **holds** |", "### fig0.1: holds\n",
        "| Case | Measured | Limit | Within |\n|---|---|---|---|\n|  | 3 | ≤ 4 | yes |\n",
        "| error | about 0.06 | 0.061 |", "[All statements](#all-statements)\n\nBecause.",
        "![A picture](fig0/a.png)", "![A plot](fig0/b.png)",
        "[PDF](fig0/b.pdf), [SVG](fig0/b.svg), [gnuplot](fig0/b.gp)"})
    EXPECT_NE(markdown.find(part), std::string::npos) << part << "\n" << markdown;
  for (const char* part :
       {"<h2 id=\"fig0\">fig0: A test<", "<em>done</em>", "<td>x &lt; y</td>", "<td>a|b</td>",
        "<strong>holds</strong>", "<td>total</td>", "<td>normal</td><td>–</td>",
        "<img class=\"picture\" src=\"fig0/a.png\"", "<a href=\"fig0/a.csv\">",
        "<th>Measured</th><th>Limit</th>", "<td>3</td><td>≤ 4</td><td>yes</td>",
        "<td>about 0.06</td><td>0.061</td>", "<img class=\"column\" src=\"fig0/b.svg\"",
        "href=\"fig0/b.pdf\"", "@page { size: A4;"})
    EXPECT_NE(html.find(part), std::string::npos) << part << "\n" << html;
  EXPECT_EQ(html.find("Quick"), std::string::npos);
}

/// Every place that the page names, once each.
std::set<std::string> places_of(const std::string& html) {
  std::set<std::string> places;
  for (std::size_t at = 0; (at = html.find(" id=\"", at)) != std::string::npos; ++at) {
    const std::string place = html.substr(at + 5, html.find('"', at + 5) - at - 5);
    EXPECT_TRUE(places.insert(place).second) << place << " is there twice";
  }
  return places;
}

TEST_F(WrittenReport, OpensWithATallyTheCommandAndLinksToTheChapters) {
  const auto statement = [](Verdict verdict) {
    return Statement{"a paper", "a claim", {passed("one"), failed("two")}, verdict, "Because."};
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
      "# Title\n\n**2 of 5 statements hold, 1 holds under conditions, 1 does not hold, 1 is too coarse to "
      "tell.**\n\n**Quick run.** "))
      << markdown;
  EXPECT_NE(markdown.find("\n\nkappaflow 1.2, 2026-01-02T03:04:05Z: `kappaflow experiment fig0 fig-1`\n\n"
                          "## Contents\n\n"),
            std::string::npos)
      << markdown;
  EXPECT_NE(markdown.find("- [fig0: One, two & three](#fig0-one-two--three): 2 of 3 statements hold, 1 does "
                          "not hold\n"),
            std::string::npos)
      << markdown;
  EXPECT_NE(markdown.find("| 3 (two) | ≤ 2 | 1 of 2 | **too coarse to tell** |"), std::string::npos)
      << markdown;
  EXPECT_NE(markdown.find("*Quick: turns 1 instead of 3.*"), std::string::npos) << markdown;
  EXPECT_NE(html.find("<p class=\"quick\">Quick: turns 1 instead of 3.</p>"), std::string::npos) << html;
  EXPECT_NE(html.find("<strong>Quick run.</strong>"), std::string::npos) << html;
  // Every link within the page goes somewhere.
  const std::set<std::string> places = places_of(html);
  std::size_t links = 0;
  for (std::size_t at = 0; (at = html.find("href=\"#", at)) != std::string::npos; ++at, ++links) {
    const std::string name = html.substr(at + 7, html.find('"', at + 7) - at - 7);
    EXPECT_TRUE(places.contains(name)) << name << "\n" << html;
  }
  EXPECT_EQ(links, 3u + 2 * 5u + 2u)
      << "the contents, each statement to its chapter and back, and each chapter";
  // As many rows as the tally says.
  std::size_t rows = 0;
  for (std::size_t at = 0; (at = html.find("<tr id=\"all-", at)) != std::string::npos; ++at) ++rows;
  EXPECT_EQ(rows, 5u);
}

}  // namespace
}  // namespace kappaflow
