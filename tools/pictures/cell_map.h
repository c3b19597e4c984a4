// Tables of coloured cells with texts in them: maps of where something holds.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace kappaflow {

struct MapCell {
  std::size_t kind = 0;  ///< colours it
  std::string above, below;
};

struct CellMap {
  std::string title, x_label, y_label;
  std::vector<std::string> columns, rows;  ///< names, from left and from below
  std::vector<MapCell> cells;              ///< row by row from below
};

/// Kinds of cells that have a colour.
inline constexpr std::size_t kMapKinds = 4;

/// Draws one map or pairs of them across a journal's page, 183 mm, and below them what the kinds of cells
/// mean, as draw_plots() draws plots. kinds: kMapKinds names at most.
void draw_cell_maps(const std::filesystem::path& folder, const std::string& name,
                    std::span<const std::string> kinds, std::span<const CellMap> maps);

}  // namespace kappaflow
