// The mesh that a tracker starts from: the isosurface with well-shaped triangles.
#pragma once

#include "surface/field/field.h"
#include "surface/field/projection.h"
#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {

/// f = 0 as a closed mesh, oriented outward, with edges of about `spacing` [m] and its vertices projected on
/// the surface (or flagged as unprojected): the extracted isosurface, remeshed (see Remesher) to edges of one
/// length and smoothed in the tangent planes, in turn. Throws as extract_isosurface does.
TriangleMesh initial_mesh(const Field& field, double spacing, const ProjectionOptions& projection);

}  // namespace kappaflow
