// What of a scene fills a picture.
#pragma once

#include <vtkPolyData.h>

#include <span>
#include <vector>

#include "scenes/view.h"

namespace kappaflow {

/// A box that lies along the axes of a view: right, up and towards the viewer.
struct Framing {
  Vec3 centre = Vec3::Zero();  ///< along these axes [m]
  Vec3 half = Vec3::Ones();    ///< of the box's edges [m]
};

/// The axes of a view as rows: right, up, towards the viewer.
Mat3 view_axes(const View& view);

/// The box around the points of all parts (null: none) but for a share of `left_out` of them at each of its
/// faces. Without points: the box around the origin.
Framing framing(std::span<vtkPolyData* const> parts, const View& view, double left_out);

/// One after the other as a camera follows them that knows what comes: at each the largest edges within
/// `reach` before and after, and of these and the centres the means over as many, weighted with
/// (1 - (distance / (reach + 1))^2)^2.
std::vector<Framing> followed(std::span<const Framing> framings, int reach);

}  // namespace kappaflow
