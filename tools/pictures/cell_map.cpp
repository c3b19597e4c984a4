#include "tools/pictures/cell_map.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/pictures/plot_page.h"

namespace kappaflow {
namespace {

constexpr double kCellHeight = 6.2, kMapAbove = 6, kMapBelow = 9.5, kMapYLabel = 5.5, kMapRight = 3,
                 kLegendHeight = 7;
constexpr double kCellType = 5.5;  // type in the cells
// Tints that black type can be read on and that the colour-blind tell apart.
constexpr const char* kColours[kMapKinds] = {"#eeeeee", "#f7cf8b", "#a9d6f5", "#6fc7a0"};

double map_height(const CellMap& map) {
  return kMapAbove + kCellHeight * static_cast<double>(map.rows.size()) + kMapBelow;
}

std::string name_ticks(char axis, const std::vector<std::string>& names) {
  std::string list;
  for (std::size_t k = 0; k < names.size(); ++k)
    list += fmt::format("{}'{}' {}", k == 0 ? "" : ", ", names[k], static_cast<double>(k) + 0.5);
  return fmt::format("set {0}range [0:{1}]\nset {0}tics scale 0 ({2})\n", axis, names.size(), list);
}

std::string cell_lines(const CellMap& map) {
  std::string lines = "unset object\nunset label\n";
  for (std::size_t c = 0; c < map.cells.size(); ++c) {
    const std::size_t x = c % map.columns.size(), y = c / map.columns.size();
    const MapCell& cell = map.cells[c];
    lines +=
        fmt::format("set object rectangle from {},{} to {},{} fc rgb '{}' fs solid border lc rgb 'white'\n",
                    x, y, x + 1, y + 1, kColours[cell.kind]);
    const auto label = [&](const std::string& text, double height) {
      return fmt::format("set label {} at {},{} center font ',{}' front\n", quoted(text),
                         static_cast<double>(x) + 0.5, static_cast<double>(y) + height, kCellType);
    };
    lines += label(cell.above, 0.73) + label(cell.below, 0.3);
  }
  return lines;
}

/// Within a cell of the page whose upper left corner is at (left, top) from below.
std::string map_lines(const CellMap& map, double left, double top, double width, double page_height) {
  double names = 0;
  for (const std::string& row : map.rows) names = std::max(names, text_width(row));
  const auto share = [](double length, double of) { return fmt::format("{:.4f}", length / of); };
  return fmt::format("set title {} offset 0,-0.5 font ',{}'\nset xlabel {}\nset ylabel {}\n",
                     quoted(map.title), kTitle, quoted(map.x_label), quoted(map.y_label)) +
         "set lmargin at screen " + share(left + kMapYLabel + names + 2, kPage) + "\nset rmargin at screen " +
         share(left + width - kMapRight, kPage) + "\nset tmargin at screen " +
         share(top - kMapAbove, page_height) + "\nset bmargin at screen " +
         share(top - map_height(map) + kMapBelow, page_height) + "\n" + name_ticks('x', map.columns) +
         name_ticks('y', map.rows) + cell_lines(map) + "plot NaN notitle\n";
}

/// At the foot of the page.
std::string legend_lines(std::span<const std::string> kinds, double page_height) {
  std::string lines = "unset object\nunset label\nunset title\nunset xlabel\nunset ylabel\nunset tics\n";
  double x = kMapYLabel;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    lines += fmt::format(
        "set object rectangle from screen {:.4f}, screen {:.4f} to screen {:.4f}, screen {:.4f} fc rgb '{}' "
        "fs "
        "solid border lc rgb '#999999'\nset label {} at screen {:.4f}, screen {:.4f} left\n",
        x / kPage, 1.5 / page_height, (x + 4) / kPage, 4.5 / page_height, kColours[k], quoted(kinds[k]),
        (x + 5.5) / kPage, 3 / page_height);
    x += 9 + text_width(kinds[k]);
  }
  return lines + "plot NaN notitle\n";
}

}  // namespace

void draw_cell_maps(const std::filesystem::path& folder, const std::string& name,
                    std::span<const std::string> kinds, std::span<const CellMap> maps) {
  double height = kLegendHeight;
  std::vector<double> row_heights;
  for (std::size_t m = 0; m < maps.size(); m += 2) {
    row_heights.push_back(map_height(maps[m]));
    if (m + 1 < maps.size()) row_heights.back() = std::max(row_heights.back(), map_height(maps[m + 1]));
    height += row_heights.back();
  }
  std::string drawing = "unset border\nset key off\n";
  double top = height;
  for (std::size_t m = 0; m < maps.size(); ++m) {
    const double left = m % 2 == 0 ? 0 : kPage / 2;
    drawing += map_lines(maps[m], left, top, maps.size() == 1 ? kPage : kPage / 2, height);
    if (m % 2 == 1) top -= row_heights[m / 2];
  }
  drawing += legend_lines(kinds, height);
  draw_page(folder, name, page_script(name, "", kPage, height, drawing));
}

}  // namespace kappaflow
