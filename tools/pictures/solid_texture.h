// What pictures show of where the surface was in the first mesh.
#pragma once

#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include <filesystem>
#include <string>

#include "surface/measure/texture.h"

namespace kappaflow {

/// A function of the rest position.
struct SolidTexture {
  enum class Kind {
    checker,  ///< cubes of two colours, see checker_colours()
    stripes,  ///< slices across the cubes' diagonal, sqrt(1/12) of a cube's edge thick
    grid,     ///< the cubes' faces as lines, 0.08 edges wide where they cross the surface at right angles
    image,    ///< at texture_coordinates()
  };
  Kind kind = Kind::checker;
  // Of images:
  vtkSmartPointer<vtkImageData> image;  ///< red, green, blue; (0, 0) is its lower left corner
  Bounds box;                           ///< around the first mesh
  TextureProjection projection = TextureProjection::box;
};

/// Whether the name is that of a texture: checker, stripes, grid, or a file's that ends in .png, .jpg, .jpeg.
bool is_texture(const std::string& name);

/// The texture of that name; box and projection count for images. Throws IoError where an image's file cannot
/// be read. Precondition: is_texture(name).
SolidTexture solid_texture(const std::string& name, const Bounds& box, TextureProjection projection);

}  // namespace kappaflow
