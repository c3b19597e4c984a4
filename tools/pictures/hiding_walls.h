// Walls that stand between the viewer and the liquid.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <span>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// One entry a triangle of the walls: whether it belongs to a face that hides more than a tenth of the
/// liquid's vertices (some hundreds of them are asked) from a viewer in direction `from`. A face is what is
/// joined without an edge sharper than 40 degrees: one side of a box, the inside of a bowl. So the near sides
/// of a tank are found, and not its floor.
std::vector<char> hiding_triangles(vtkPolyData& walls, vtkPolyData& liquid, const Vec3& from);

/// The walls' triangles that have this flag.
vtkSmartPointer<vtkPolyData> part_of(vtkPolyData& walls, std::span<const char> flag, char value);

/// Their sharp edges and rims as lines.
vtkSmartPointer<vtkPolyData> sharp_edges(vtkPolyData& walls);

}  // namespace kappaflow
