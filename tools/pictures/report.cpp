#include "tools/pictures/report.h"

#include "tools/io/files.h"
#include "tools/pictures/report_formats.h"

namespace kappaflow {

void write_report(const std::filesystem::path& folder, const ReportHead& head,
                  const std::vector<Report>& reports) {
  write_file(folder / "report.md", report_markdown(head, reports));
  write_file(folder / "report.html", report_html(head, reports));
}

}  // namespace kappaflow
