// A surface with the checker of its rest positions, evaluated for every pixel.
#pragma once

#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

namespace kappaflow {

/// surface: as surface_data() makes it, with point array rest_position and field arrays checker_origin and
/// checker_edge. The edges of the cubes are as straight as the rest positions are smooth, whatever the mesh's
/// resolution; the colours are those of checker_colours(). Throws InvalidInput where an array is missing.
vtkSmartPointer<vtkActor> checker_actor(vtkPolyData& surface);

}  // namespace kappaflow
