// How far a surface moves from one instant to another, where nothing but its field is known.
#pragma once

#include <string>

#include "surface/field/field.h"

namespace kappaflow {

/// The furthest that the surface of a point cloud may move from one instant to the next, in sigma: beyond it
/// the mean of both fields no longer stands for the field between them (docs/track.md has measurements).
inline constexpr double kLargestCloudMotion = 0.1;

/// How far, in units of sigma [m], a surface moves between two of its fields: the distance to the first
/// surface that 95 % of the second surface's vertices keep within; 0 where one of them is empty. What moves
/// along the surface does not show. Throws as extract_isosurface does.
double surface_motion(const Field& before, const Field& after, double sigma);

/// Throws InvalidInput where that is more than kLargestCloudMotion. name: how the message begins.
void check_cloud_motion(const std::string& name, const Field& before, const Field& after, double sigma);

}  // namespace kappaflow
