// Pictures of surfaces side by side, drawn with VTK.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "scenes/view.h"
#include "tools/pictures/colouring.h"

namespace kappaflow {

/// One surface of a picture.
struct Panel {
  std::string title;  ///< above it
  vtkSmartPointer<vtkPolyData> surface;
};

/// How a picture looks; the same view in every panel.
struct PictureStyle {
  int columns = 0;                            ///< panels a row; 0: all in one row
  int panel_width = 900, panel_height = 800;  ///< [pixels]
  bool edges = false;                         ///< draw the triangles' edges
  double wall_opacity = 1;
  View view{};
  std::optional<Colouring> colouring{};  ///< of the surfaces; none: the colours of their array "checker"
};

/// Draws the panels, each with `boundary` (may be null) around its surface, so that `subject` fills a panel;
/// where that is null, so that each surface fills its own.
/// Throws InvalidInput unless the file's name ends in .png, IoError where there is no display or the file
/// cannot be written.
void draw_picture(const std::filesystem::path& file, std::span<const Panel> panels, vtkPolyData* boundary,
                  vtkPolyData* subject, const PictureStyle& style);

}  // namespace kappaflow
