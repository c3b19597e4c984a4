// What report.md and report.html have in common.
#pragma once

#include <string>
#include <vector>

#include "tools/pictures/report.h"

namespace kappaflow {

inline constexpr const char* kContents = "Contents";
inline constexpr const char* kStatements = "All statements";

std::vector<const Statement*> statements_of(const std::vector<Report>& reports);

/// "fig3: One particle moves".
std::string heading(const Report& report);

/// "fig3.1", counted from 1.
std::string number_of(const Report& report, std::size_t statement);

/// What is said of smaller variants above everything; empty where there are none.
std::string quick_text(const std::vector<Report>& reports);

/// Columns of the table of all statements, in which each has a row: its number, then statement_cells() with
/// the measurement that decides beside its limit.
inline const std::vector<std::string> kStatementHeader{"",      "Statement", "Source", "Measured",
                                                       "Limit", "Cases",     "Verdict"};
std::vector<std::string> statement_cells(const Statement& statement);

/// A row a case of a statement: what was measured beside the limit.
Table check_table(const Statement& statement);

/// The report's file of a plot in another format: "fig8/fig8.pdf".
std::string in_format(const Figure& plot, const std::string& format);

}  // namespace kappaflow
