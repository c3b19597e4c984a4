// What experiments found: statements beside measurements, tables and pictures, as Markdown and as HTML.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/pictures/statement.h"

namespace kappaflow {

/// Rows of text (Markdown) under a header.
struct Table {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// A picture file beside the report. A plot's has the same name with .pdf, .svg and .gp beside it, and is as
/// wide as a column of a journal or as a page.
struct Figure {
  enum class Kind { picture, column_plot, page_plot };
  std::string file, caption;
  Kind kind = Kind::picture;
};

/// The chapter of one experiment.
struct Report {
  std::string name, title;
  std::string smaller;       ///< what a smaller variant did otherwise; empty: nothing
  std::string introduction;  ///< Markdown: what was done, with all the numbers that are needed to repeat it
  std::vector<Statement> statements;
  Table beside;  ///< where a paper prints a figure: what it says of that, beside what came out here
  std::vector<Table> tables;
  std::vector<Figure> figures;
  std::vector<std::string> files;  ///< further results, relative to the report
  double seconds = 0;              ///< wall time
};

/// What stands above the chapters.
struct ReportHead {
  std::string title;
  std::string program;  ///< its name and version
  std::string command;  ///< as it was called
  std::string date;
};

/// Writes report.md and report.html into the folder: how many statements hold; contents; all statements, each
/// with the number that decides, its limit and a link to its chapter; then the chapters, in which each
/// statement has all of its numbers and a link back. File names in the reports are relative to the folder;
/// report.html prints on A4. Throws IoError.
void write_report(const std::filesystem::path& folder, const ReportHead& head,
                  const std::vector<Report>& reports);

}  // namespace kappaflow
