#include "tools/pictures/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/errors.h"
#include "tools/io/files.h"
#include "tools/pictures/process.h"

namespace kappaflow {
namespace {

constexpr int kPlotWidth = 860, kPlotHeight = 560;  // [pixels]

// Colours that the colour-blind tell apart (Okabe & Ito 2008).
constexpr const char* kColours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                    "#56b4e9", "#e69f00", "#000000", "#999933"};

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "''" : std::string(1, c);
  return result + "'";
}

std::string data_name(std::size_t plot, std::size_t curve) {
  return fmt::format("$plot{}_curve{}", plot, curve);
}

std::string data_block(const std::string& name, const Curve& curve, bool log_y) {
  std::string block = name + " << END\n";
  for (const Vec2& p : curve.points) {
    const bool drawn = p.allFinite() && (!log_y || p.y() > 0);
    block += drawn ? fmt::format("{:.10g} {:.10g}\n", p.x(), p.y()) : "\n";
  }
  return block + "END\n";
}

std::string plot_command(std::size_t index, const Plot& plot) {
  std::string script = fmt::format("set title {}\nset xlabel {}\nset ylabel {}\n", quoted(plot.title),
                                   quoted(plot.x_label), quoted(plot.y_label));
  script += plot.log_y ? "set logscale y\nset format y '%.0e'\n" : "unset logscale y\nset format y '%g'\n";
  script += plot.scatter ? "set logscale x\nset format x '%.0e'\n" : "unset logscale x\nset format x '%g'\n";
  script += "plot ";
  for (std::size_t c = 0; c < plot.curves.size(); ++c) {
    // Few points are marked; many make a line.
    const char* style = plot.scatter                         ? "points pt 7 ps 0.4"
                        : plot.curves[c].points.size() <= 31 ? "linespoints pt 7 ps 0.7"
                                                             : "lines";
    // Dashes on every other curve, so that of two that coincide both are seen.
    const int dashes = c % 2 == 0 ? 1 : 2;
    script +=
        fmt::format("{}{} with {} lw 2 dt {} lc rgb '{}' title {}", c == 0 ? "" : ", ", data_name(index, c),
                    style, dashes, kColours[c % std::size(kColours)], quoted(plot.curves[c].title));
  }
  return script + "\n";
}

std::string plot_script(const std::string& name, std::span<const Plot> plots) {
  std::string script = fmt::format("# gnuplot {0}.gp draws {0}.png\n", name);
  for (std::size_t p = 0; p < plots.size(); ++p)
    for (std::size_t c = 0; c < plots[p].curves.size(); ++c)
      script += data_block(data_name(p, c), plots[p].curves[c], plots[p].log_y);
  script += fmt::format("set terminal pngcairo size {},{} font 'sans,13' noenhanced\n",
                        kPlotWidth * plots.size(), kPlotHeight);
  script += "set grid lc rgb '#dddddd'\nset key outside right center\n";
  script += fmt::format("if (!exists('picture')) picture = '{}.png'\nset output picture\n", name);
  script += fmt::format("set multiplot layout 1,{}\n", plots.size());
  for (std::size_t p = 0; p < plots.size(); ++p) script += plot_command(p, plots[p]);
  return script + "unset multiplot\nset output\n";
}

}  // namespace

void draw_plots(const std::filesystem::path& folder, const std::string& name, std::span<const Plot> plots) {
  write_file(folder / (name + ".gp"), plot_script(name, plots));
  const UnfinishedFile unfinished(folder / (name + ".png.tmp"));
  const int status = run_command(
      {"gnuplot", "-e", fmt::format("picture = '{}'", unfinished.path().filename().string()), name + ".gp"},
      folder);
  if (status != 0)
    throw IoError((folder / (name + ".gp")).string(), fmt::format("gnuplot failed with status {}", status));
  std::error_code error;
  std::filesystem::rename(unfinished.path(), folder / (name + ".png"), error);
  if (error) throw IoError((folder / (name + ".png")).string(), "cannot be written: " + error.message());
}

void require_gnuplot() {
  if (run_command({"gnuplot", "--version"}, "/") != 0)
    throw IoError("gnuplot", "cannot be run; it draws the plots: apt-get install gnuplot-nox");
}

}  // namespace kappaflow
