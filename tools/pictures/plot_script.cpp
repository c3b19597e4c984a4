#include "tools/pictures/plot_script.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "tools/pictures/plot_axis.h"
#include "tools/pictures/plot_labels.h"
#include "tools/pictures/plot_page.h"

namespace kappaflow {
namespace {

// Lengths are in millimetres.
constexpr double kHeight = 62;  // of one plot with all that stands around it
constexpr double kLine = 3.2;   // from one line of text to the next
constexpr double kBelow = 10, kAbove = 6, kYLabel = 5.5, kAroundTicks = 2;
constexpr double kReach = 3, kSample = 5,
                 kGap = 1;  // from a curve's end to its sample, the sample, to its name

constexpr std::size_t kFewPoints = 31;  // as many are all marked
constexpr int kMarks = 6;               // on a curve of more
constexpr double kAtTheEnd = 0.98;  // of the axis: curves that reach it have their names beside their ends

// Colours that the colour-blind tell apart (Okabe & Ito 2008), and gnuplot's numbers of the marks, by which
// curves are told apart without colours.
struct LineStyle {
  const char* colour;
  int mark;
};
constexpr LineStyle kStyles[kPlotStyles] = {{"#0072b2", 7}, {"#d55e00", 4},  {"#009e73", 9},  {"#cc79a7", 12},
                                            {"#56b4e9", 5}, {"#e69f00", 10}, {"#000000", 13}, {"#999933", 6},
                                            {"#882255", 2}, {"#888888", 8}};
constexpr LineStyle kReference{"#000000", 0};

/// Of a tick: raised digits are smaller, and what raises them has no width.
double tick_width(const std::string& text) {
  const std::size_t raised = text.find('^');
  if (raised == std::string::npos) return text_width(text);
  return text_width(text.substr(0, raised)) + 0.8 * text_width(text.substr(raised + 2)) - 0.8 * kCharacter;
}

/// A plot with its axes, and where it lies on the page.
struct PlacedPlot {
  const Plot* plot = nullptr;
  Axis x, y;
  double left = 0, below = 0, width = 0, height = 0;  ///< of the area between the axes

  bool draws(const Vec2& p) const {
    return p.allFinite() && (!x.logarithmic || p.x() > 0) && (!y.logarithmic || p.y() > 0);
  }
};

std::vector<double> numbers_of(const Plot& plot, int coordinate, bool positive) {
  std::vector<double> numbers;
  for (const Curve& curve : plot.curves)
    for (const Vec2& p : curve.points)
      if (p.allFinite() && (!positive || p[coordinate] > 0)) numbers.push_back(p[coordinate]);
  return numbers;
}

void choose_axes(PlacedPlot& placed) {
  const Plot& plot = *placed.plot;
  const bool log_y = plot.log_y || spans_decades(numbers_of(plot, 1, false));
  placed.x =
      axis_of(numbers_of(plot, 0, plot.log_x), plot.log_x, plot.log_x ? AxisEnds::round : AxisEnds::of_data);
  placed.y = axis_of(numbers_of(plot, 1, log_y), log_y, AxisEnds::round);
}

double width_of_names(const Plot& plot) {
  double width = 0;
  for (const Curve& curve : plot.curves) width = std::max(width, text_width(curve.title));
  return width;
}

/// Within a cell of the page from (left, below) on.
PlacedPlot place(const Plot& plot, double left, double below, double width) {
  PlacedPlot placed;
  placed.plot = &plot;
  choose_axes(placed);
  double ticks = 0;
  for (const Tick& tick : placed.y.ticks) ticks = std::max(ticks, tick_width(tick.text));
  placed.left = left + kYLabel + ticks + kAroundTicks;
  placed.below = below + kBelow;
  placed.width = left + width - kReach - kSample - kGap - width_of_names(plot) - 1 - placed.left;
  placed.height = kHeight - kBelow - kAbove;
  return placed;
}

/// A column is too narrow for several plots, and for one beside long names.
double page_width(std::span<const Plot> plots) {
  return plots.size() > 1 || width_of_names(plots.front()) > kColumn / 3 ? kPage : kColumn;
}

std::vector<PlacedPlot> place_all(std::span<const Plot> plots) {
  const std::size_t columns = plots.size() > 1 ? 2 : 1, rows = (plots.size() + columns - 1) / columns;
  const double width = page_width(plots) / static_cast<double>(columns);
  std::vector<PlacedPlot> placed;
  placed.reserve(plots.size());
  for (std::size_t p = 0; p < plots.size(); ++p) {
    const std::size_t column = p % columns, rows_below = rows - 1 - p / columns;
    placed.push_back(place(plots[p], static_cast<double>(column) * width,
                           static_cast<double>(rows_below) * kHeight, width));
  }
  return placed;
}

LineStyle style_of(const Plot& plot, std::size_t curve) {
  const Curve& c = plot.curves[curve];
  if (c.look == Look::reference) return kReference;
  return kStyles[(c.style >= 0 ? static_cast<std::size_t>(c.style) : curve) % kPlotStyles];
}

std::string data_name(std::size_t plot, std::size_t curve, const char* what) {
  return fmt::format("$plot{}_{}{}", plot + 1, what, curve + 1);
}

std::string point_line(const Vec2& p) {
  return fmt::format("{:.10g} {:.10g}\n", p.x(), p.y());
}

/// The points that have marks: all of few; of many some, which are others on the next curve, so that of two
/// that coincide both are seen.
std::vector<Vec2> marked(const PlacedPlot& placed, std::size_t curve) {
  const Curve& c = placed.plot->curves[curve];
  std::vector<Vec2> drawn, marks;
  std::ranges::copy_if(c.points, std::back_inserter(drawn), [&](const Vec2& p) { return placed.draws(p); });
  if (c.look == Look::points || drawn.size() <= kFewPoints) return drawn;
  const double first = (static_cast<double>(curve) + 0.5) / static_cast<double>(placed.plot->curves.size());
  marks.reserve(kMarks);
  for (int k = 0; k < kMarks; ++k)
    marks.push_back(
        drawn[static_cast<std::size_t>((k + first) / kMarks * static_cast<double>(drawn.size()))]);
  return marks;
}

std::string data_blocks(const PlacedPlot& placed, std::size_t index) {
  std::string blocks;
  const auto block = [&](const std::string& name, const std::vector<Vec2>& points) {
    blocks += name + " << END\n";
    for (const Vec2& p : points) blocks += placed.draws(p) ? point_line(p) : "\n";
    blocks += "END\n";
  };
  for (std::size_t c = 0; c < placed.plot->curves.size(); ++c) {
    const Curve& curve = placed.plot->curves[c];
    if (curve.look != Look::points) block(data_name(index, c, "curve"), curve.points);
    if (curve.look != Look::reference) block(data_name(index, c, "marks"), marked(placed, c));
  }
  return blocks;
}

std::string axis_lines(char name, const Axis& axis) {
  std::string lines =
      fmt::format("unset logscale {0}\nset {0}range [{1:.10g}:{2:.10g}]\n{3}set {0}tics (", name, axis.low,
                  axis.high, axis.logarithmic ? fmt::format("set logscale {}\n", name) : "");
  for (std::size_t t = 0; t < axis.ticks.size(); ++t)
    lines += fmt::format("{}'{}' {:.10g}{}", t == 0 ? "" : ", ", axis.ticks[t].text, axis.ticks[t].at,
                         axis.ticks[t].text.empty() ? " 1" : "");
  return lines + ")\n";
}

/// How high each curve ends, 0 to 1; nothing unless all end at the right end of the axis.
std::optional<std::vector<double>> heights_of_ends(const PlacedPlot& placed) {
  std::vector<double> heights;
  for (const Curve& curve : placed.plot->curves) {
    const auto last = std::find_if(curve.points.rbegin(), curve.points.rend(),
                                   [&](const Vec2& p) { return placed.draws(p); });
    if (last == curve.points.rend() || placed.x.share(last->x()) < kAtTheEnd) return std::nullopt;
    heights.push_back(placed.y.share(last->y()));
  }
  return heights;
}

/// A place right of the axes: [mm] from them, and from 0 at their lower end to 1 at their upper one.
struct Beside {
  double x, y;
};

std::string place_text(const PlacedPlot& placed, const Beside& at) {
  return fmt::format("graph {:.4f}, graph {:.4f}", 1 + at.x / placed.width, at.y);
}

std::string line_beside(const PlacedPlot& placed, const Beside& from, const Beside& to,
                        const LineStyle& style) {
  return fmt::format("set arrow from {} to {} nohead lw 1 lc rgb '{}'\n", place_text(placed, from),
                     place_text(placed, to), style.colour);
}

std::string label_beside(const PlacedPlot& placed, const Beside& at, const std::string& text,
                         const std::string& mark) {
  return fmt::format("set label {} at {} left{}\n", quoted(text), place_text(placed, at), mark);
}

/// A sample of a curve and its name at that height.
std::string name_at(const PlacedPlot& placed, std::size_t c, double height) {
  const Curve& curve = placed.plot->curves[c];
  const LineStyle style = style_of(*placed.plot, c);
  std::string lines = label_beside(placed, {kReach + kSample + kGap, height}, curve.title, "");
  if (curve.look != Look::points)
    lines += line_beside(placed, {kReach, height}, {kReach + kSample, height}, style);
  if (style.mark > 0)
    lines += label_beside(placed, {kReach + kSample / 2, height}, "",
                          fmt::format(" point pt {} ps mark lw 0.7 lc rgb '{}'", style.mark, style.colour));
  return lines;
}

/// Right of the plot: the curves' names, joined to the curves' ends, or as a list.
std::string name_lines(const PlacedPlot& placed) {
  const std::vector<Curve>& curves = placed.plot->curves;
  const auto ends = heights_of_ends(placed);
  const double gap = kLine / placed.height;
  std::vector<double> heights;
  heights.reserve(curves.size());
  for (std::size_t c = 0; c < curves.size(); ++c) heights.push_back(1 - gap * (static_cast<double>(c) + 0.5));
  if (ends) heights = spread_out(*ends, gap, 0, 1);
  std::string lines = "unset arrow\nunset label\n";
  for (std::size_t c = 0; c < curves.size(); ++c) {
    if (curves[c].title.empty()) continue;
    if (ends && curves[c].look != Look::points)
      lines += line_beside(placed, {0, (*ends)[c]}, {kReach, heights[c]}, style_of(*placed.plot, c));
    lines += name_at(placed, c, heights[c]);
  }
  return lines;
}

std::string curve_list(const PlacedPlot& placed, std::size_t index) {
  std::string list;
  const auto add = [&](const std::string& element) {
    list += (list.empty() ? "plot " : ", \\\n  ") + element;
  };
  for (std::size_t c = 0; c < placed.plot->curves.size(); ++c) {
    const Curve& curve = placed.plot->curves[c];
    const LineStyle style = style_of(*placed.plot, c);
    if (curve.look != Look::points)
      add(fmt::format("{} with lines lw 1 lc rgb '{}' notitle", data_name(index, c, "curve"), style.colour));
    if (curve.look == Look::reference) continue;
    const bool cloud = curve.look == Look::points && curve.points.size() > 10 * kFewPoints;
    add(fmt::format("{} with points pt {} ps {} lw 0.7 lc rgb '{}' notitle", data_name(index, c, "marks"),
                    style.mark, cloud ? "0.4*mark" : "mark", style.colour));
  }
  return list + "\n";
}

std::string plot_lines(const PlacedPlot& placed, std::size_t index, double page_width, double page_height) {
  const Plot& plot = *placed.plot;
  return fmt::format("set title {} offset 0,-0.5 font ',{}'\nset xlabel {}\nset ylabel {}\n",
                     quoted(plot.title), kTitle, quoted(plot.x_label), quoted(plot.y_label)) +
         fmt::format("set lmargin at screen {:.4f}\nset rmargin at screen {:.4f}\n", placed.left / page_width,
                     (placed.left + placed.width) / page_width) +
         fmt::format("set bmargin at screen {:.4f}\nset tmargin at screen {:.4f}\n",
                     placed.below / page_height, (placed.below + placed.height) / page_height) +
         axis_lines('x', placed.x) + axis_lines('y', placed.y) + name_lines(placed) +
         curve_list(placed, index);
}

}  // namespace

std::string plot_script(const std::string& name, std::span<const Plot> plots) {
  const std::vector<PlacedPlot> placed = place_all(plots);
  const std::size_t rows = (plots.size() + 1) / 2;
  const double width = page_width(plots), height = kHeight * static_cast<double>(rows);
  std::string data;
  for (std::size_t p = 0; p < placed.size(); ++p) data += data_blocks(placed[p], p);
  std::string drawing =
      "set border 3 lw 0.5\nset tics nomirror out scale 0.5,0.25\nset grid lw 0.4 lt 1 lc rgb '#dddddd'\n";
  for (std::size_t p = 0; p < placed.size(); ++p) drawing += plot_lines(placed[p], p, width, height);
  return page_script(name, data, width, height, drawing);
}

}  // namespace kappaflow
