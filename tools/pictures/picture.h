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
#include "tools/pictures/framing.h"
#include "tools/pictures/solid_texture.h"

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
  View view{};
  SolidTexture texture{};                ///< of the surfaces
  std::optional<Colouring> colouring{};  ///< instead of the texture
};

/// What stands around the liquid; null: nothing.
struct DrawnWalls {
  vtkSmartPointer<vtkPolyData> solid, glass;  ///< glass: what is in the way; its edges are drawn
};

/// Draws the panels, each with the walls around its surface, so that what is framed fills a panel (none: so
/// that each surface fills its own), and below them the colour bar of all.
/// Throws InvalidInput unless the file's name ends in .png, IoError where there is no display or the file
/// cannot be written.
void draw_picture(const std::filesystem::path& file, std::span<const Panel> panels, const DrawnWalls& walls,
                  const std::optional<Framing>& framing, const PictureStyle& style);

}  // namespace kappaflow
