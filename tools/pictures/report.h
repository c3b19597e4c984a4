// What an experiment found: statements beside measurements, tables and pictures, as Markdown and as HTML.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kappaflow {

/// too_coarse: of a smaller variant that does not meet a limit which is the whole one's.
enum class Verdict { holds, under_conditions, does_not_hold, too_coarse };

/// What is claimed, in words.
struct Claim {
  std::string source;  ///< who says it and where
  std::string statement;
  std::string reason;  ///< why it should hold, or what was measured
};

/// A claim beside what was measured.
struct Statement {
  std::string source;  ///< who says it and where
  std::string statement;
  std::string measured;
  Verdict verdict = Verdict::does_not_hold;
  std::string reason;  ///< why the verdict is what it is, and its conditions
};

/// One of the cases that a statement is about.
struct Check {
  std::string what;
  bool holds = false;
};
/// holds where all checks do, does_not_hold where none does, else under_conditions. The reason is the
/// claim's, followed by the checks that hold and those that do not where they differ.
Statement judged(const Claim& claim, std::string measured, const std::vector<Check>& checks);

/// Rows of text under a header.
struct Table {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// A picture file beside the report.
struct Figure {
  std::string file, caption;
};

/// The chapter of one experiment.
struct Report {
  std::string name, title;
  std::string smaller;       ///< what a smaller variant did otherwise; empty: nothing
  std::string introduction;  ///< Markdown: what was done, with all the numbers that are needed to repeat it
  std::vector<Statement> statements;
  std::vector<Table> tables;
  std::vector<Figure> figures;
  std::vector<std::string> files;  ///< further results, relative to the report
  double seconds = 0;              ///< wall time
};

/// The words of the report's last column but one.
std::string verdict_text(Verdict verdict);

/// What stands above the chapters.
struct ReportHead {
  std::string title;
  std::string program;  ///< its name and version
  std::string command;  ///< as it was called
  std::string date;
};

/// Writes report.md and report.html into the folder: how many statements hold and how many do not, a summary
/// of all, then a chapter for each experiment. File names in the reports are relative to it. Throws IoError.
void write_report(const std::filesystem::path& folder, const ReportHead& head,
                  const std::vector<Report>& reports);

}  // namespace kappaflow
