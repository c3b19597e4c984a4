// Numbers about a mesh: area, volume, triangle quality, topology.
#pragma once

#include <span>
#include <vector>

#include "surface/mesh/triangle_mesh.h"

namespace kappaflow {

/// A third of the area of the triangles around each vertex [m2]; the sum is the mesh's area.
std::vector<double> vertex_areas(std::span<const Vec3> position, std::span<const Triangle> triangles);
/// The same into `area`, one entry a vertex.
void vertex_areas(std::span<const Vec3> position, std::span<const Triangle> triangles,
                  std::span<double> area);

/// Area [m2] and signed enclosed volume [m3], positive when oriented outward.
struct AreaAndVolume {
  double area = 0;
  double volume = 0;
};
AreaAndVolume area_and_volume(std::span<const Vec3> position, std::span<const Triangle> triangles);

/// 2 inradius / circumradius = 8 (s-a)(s-b)(s-c) / (abc) in [0, 1]; 1 for an equilateral triangle, 0 for a
/// degenerate one.
double triangle_quality(const Vec3& a, const Vec3& b, const Vec3& c);

struct QualityRange {
  double min = 1;
  double mean = 1;
};
QualityRange triangle_qualities(std::span<const Vec3> position, std::span<const Triangle> triangles);

/// The smallest angle of any triangle [degrees]; 0 where one is degenerate, 60 without triangles.
double smallest_angle(std::span<const Vec3> position, std::span<const Triangle> triangles);

/// Share of the triangles that have an angle below `smallest` or above `largest` [degrees].
double angles_outside(std::span<const Vec3> position, std::span<const Triangle> triangles, double smallest,
                      double largest);

/// Not where the angles at apexes a and b, opposite the edge (u, v), sum to more than pi, beyond what
/// rounding could flip back and forth.
bool is_delaunay(const Vec3& u, const Vec3& v, const Vec3& a, const Vec3& b);

/// How far triangles are from those they were at rest.
struct TriangleDistortion {
  /// Longest edge over shortest altitude, in units of the equilateral triangle's: 1 is best; infinite for a
  /// degenerate triangle.
  double aspect_mean = 1, aspect_max = 1;
  double area_ratio_min = 1, area_ratio_max = 1;  ///< area over area at rest
};
/// Precondition: no triangle is degenerate at rest.
TriangleDistortion triangle_distortion(std::span<const Vec3> position, std::span<const Vec3> rest_position,
                                       std::span<const Triangle> triangles);

/// Cosine of the angle between the triangle's normal and the sum of those at its corners; -1 where either is
/// zero.
double facing(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal_sum);

/// Share of the triangles that have folded over: those that face away from the outward normals [unit vectors]
/// at their corners, as their sum goes.
double folded_fraction(std::span<const Vec3> position, std::span<const Vec3> normal,
                       std::span<const Triangle> triangles);

/// Connected pieces, and the total genus by Euler's formula V - E + F = 2 (components - genus).
struct MeshTopology {
  int components = 0;
  int genus = 0;
};

/// Topology of a closed mesh; vertices that no triangle uses do not count.
/// Throws TopologyError where an edge does not have exactly two triangles that run along it in opposite
/// directions.
MeshTopology mesh_topology(std::span<const Vec3> position, std::span<const Triangle> triangles);

}  // namespace kappaflow
