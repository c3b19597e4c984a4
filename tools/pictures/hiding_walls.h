// Walls that stand between the viewer and the liquid.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <cstdint>
#include <span>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// One entry a triangle of the walls, with a bit for each of up to 32 viewers, given by the direction to
/// them: whether the triangle belongs to a face that hides more than a tenth of the liquid's vertices (some
/// hundreds of them are asked) from there. A face is what is joined without an edge sharper than 40 degrees:
/// one side of a box, the inside of a bowl. So the near sides of a tank are found, and not its floor.
std::vector<std::uint32_t> hiding_triangles(vtkPolyData& walls, vtkPolyData& liquid,
                                            std::span<const Vec3> viewers);

/// The walls' triangles that hide something, or those that do not.
vtkSmartPointer<vtkPolyData> part_of(vtkPolyData& walls, std::span<const std::uint32_t> hiding, bool hides);

/// Their sharp edges and rims as lines.
vtkSmartPointer<vtkPolyData> sharp_edges(vtkPolyData& walls);

}  // namespace kappaflow
