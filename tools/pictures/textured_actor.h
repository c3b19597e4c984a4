// A surface with a texture that is evaluated for every pixel from its rest positions.
#pragma once

#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "tools/pictures/solid_texture.h"

namespace kappaflow {

/// surface: as surface_data() makes it, with point array rest_position and, but for images, field arrays
/// checker_origin and checker_edge. The texture's edges are as straight as the rest positions are smooth,
/// whatever the mesh's resolution. Throws InvalidInput where an array is missing.
vtkSmartPointer<vtkActor> textured_actor(vtkPolyData& surface, const SolidTexture& texture);

}  // namespace kappaflow
