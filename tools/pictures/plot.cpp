#include "tools/pictures/plot.h"

#include <fmt/format.h>

#include "core/errors.h"
#include "tools/io/files.h"
#include "tools/pictures/plot_script.h"
#include "tools/pictures/process.h"

namespace kappaflow {
namespace {

constexpr const char* kUnfinished = ".tmp";

}  // namespace

void draw_plots(const std::filesystem::path& folder, const std::string& name, std::span<const Plot> plots) {
  const std::filesystem::path script = folder / (name + ".gp");
  write_file(script, plot_script(name, plots));
  const auto drawn = [&](const char* format) { return folder / fmt::format("{}.{}", name, format); };
  const auto unfinished = [&](const char* format) { return UnfinishedFile(drawn(format) += kUnfinished); };
  const UnfinishedFile files[] = {unfinished(kPlotFormats[0]), unfinished(kPlotFormats[1]),
                                  unfinished(kPlotFormats[2])};
  const int status =
      run_command({"gnuplot", "-e", fmt::format("suffix = '{}'", kUnfinished), name + ".gp"}, folder);
  if (status != 0) throw IoError(script.string(), fmt::format("gnuplot failed with status {}", status));
  for (std::size_t k = 0; k < std::size(files); ++k) {
    std::error_code error;
    std::filesystem::rename(files[k].path(), drawn(kPlotFormats[k]), error);
    if (error) throw IoError(drawn(kPlotFormats[k]).string(), "cannot be written: " + error.message());
  }
}

void require_gnuplot() {
  if (run_command({"gnuplot", "--version"}, "/") != 0)
    throw IoError("gnuplot", "cannot be run; it draws the plots: apt-get install gnuplot-nox");
}

}  // namespace kappaflow
