#include "tools/pictures/plot.h"

#include "core/errors.h"
#include "tools/pictures/plot_page.h"
#include "tools/pictures/plot_script.h"
#include "tools/pictures/process.h"

namespace kappaflow {

void draw_plots(const std::filesystem::path& folder, const std::string& name, std::span<const Plot> plots) {
  draw_page(folder, name, plot_script(name, plots));
}

void require_gnuplot() {
  if (run_command({"gnuplot", "--version"}, "/") != 0)
    throw IoError("gnuplot", "cannot be run; it draws the plots: apt-get install gnuplot-nox");
}

}  // namespace kappaflow
