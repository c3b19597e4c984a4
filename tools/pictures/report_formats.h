// The two forms of a report.
#pragma once

#include <string>
#include <vector>

#include "tools/pictures/report.h"

namespace kappaflow {

/// For terminals and code hosts; links within go to headings, by the names that GitHub gives them.
std::string report_markdown(const ReportHead& head, const std::vector<Report>& reports);

/// One page for browsers and printers, with its style in it; pictures and plots are files beside it.
std::string report_html(const ReportHead& head, const std::vector<Report>& reports);

}  // namespace kappaflow
