#include "scenes/shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "core/solids.h"
#include "surface/mesh/mesh_measures.h"

namespace kappaflow {
namespace {

/// Rounding that a length in spacings may have and still count as whole.
constexpr double kWhole = 1e-6;

/// The prism over a polygon in the x-y plane, from z = lower to z = upper: corner k is vertex 2k at lower and
/// 2k + 1 at upper. The polygon runs counter-clockwise and is star-shaped from its corner 0, so a fan fills
/// the two ends.
TriangleSurface prism(const std::vector<Vec2>& polygon, double lower, double upper) {
  TriangleSurface surface;
  const int n = static_cast<int>(polygon.size());
  for (const Vec2& p : polygon) {
    surface.vertices.emplace_back(p.x(), p.y(), lower);
    surface.vertices.emplace_back(p.x(), p.y(), upper);
  }
  for (int k = 0; k < n; ++k) {
    const int a = 2 * k, b = 2 * ((k + 1) % n);
    surface.triangles.push_back({a, b, b + 1});
    surface.triangles.push_back({a, b + 1, a + 1});
  }
  for (int k = 1; k + 1 < n; ++k) {
    surface.triangles.push_back({1, 2 * k + 1, 2 * k + 3});
    surface.triangles.push_back({0, 2 * k + 2, 2 * k});
  }
  return surface;
}

/// A profile of (height along the axis, distance from it) turned about the axis through `origin`; it begins
/// and ends on the axis, where its distance is 0, and heights increase.
TriangleSurface turned(const std::vector<Vec2>& profile, const Vec3& origin, const Vec3& axis) {
  constexpr int kSides = 60;
  const Vec3 e1 = axis.unitOrthogonal(), e2 = axis.cross(e1);
  const int rings = static_cast<int>(profile.size()) - 2;
  TriangleSurface surface;
  for (int r = 1; r <= rings; ++r)
    for (int k = 0; k < kSides; ++k) {
      const double angle = 2 * std::numbers::pi * k / kSides;
      surface.vertices.push_back(origin + profile[r].x() * axis +
                                 profile[r].y() * (std::cos(angle) * e1 + std::sin(angle) * e2));
    }
  const int bottom = rings * kSides, top = bottom + 1;
  surface.vertices.push_back(origin + profile.front().x() * axis);
  surface.vertices.push_back(origin + profile.back().x() * axis);
  for (int k = 0; k < kSides; ++k) {
    const int next = (k + 1) % kSides;
    surface.triangles.push_back({bottom, next, k});
    for (int r = 0; r + 1 < rings; ++r) {
      const int a = r * kSides + k, b = r * kSides + next;
      surface.triangles.push_back({a, b, b + kSides});
      surface.triangles.push_back({a, b + kSides, a + kSides});
    }
    surface.triangles.push_back({top, (rings - 1) * kSides + k, (rings - 1) * kSides + next});
  }
  return surface;
}

template <class Keep>
std::vector<Vec3> lattice(const Vec3& first, const std::array<std::int64_t, 3>& count, double spacing,
                          const Keep& keep) {
  std::vector<std::vector<Vec3>> slabs(static_cast<std::size_t>(count[2]));
  const auto fill = [&](std::size_t k) {
    for (std::int64_t j = 0; j < count[1]; ++j)
      for (std::int64_t i = 0; i < count[0]; ++i)
        if (const Vec3 x = first + spacing * Vec3(double(i), double(j), double(k)); keep(x))
          slabs[k].push_back(x);
  };
  parallel_for(slabs.size(), fill, 1);
  std::vector<Vec3> points;
  for (const std::vector<Vec3>& slab : slabs) points.insert(points.end(), slab.begin(), slab.end());
  return points;
}

Vec3 whole_cells(const BoxShape& box, double spacing) {
  return ((box.upper - box.lower) / spacing + Vec3::Constant(kWhole)).array().floor();
}

BoxShape bounding_box(const TriangleSurface& solid) {
  BoxShape box{solid.vertices.front(), solid.vertices.front()};
  for (const Vec3& x : solid.vertices) {
    box.lower = box.lower.cwiseMin(x);
    box.upper = box.upper.cwiseMax(x);
  }
  return box;
}

/// Cells that it takes to cover the box.
Vec3 covering_cells(const BoxShape& box, double spacing) {
  return ((box.upper - box.lower) / spacing - Vec3::Constant(kWhole)).array().ceil().max(1.0);
}

double half_cells(const SphereShape& sphere, double spacing) {
  return std::floor(sphere.radius / spacing + 0.5);
}

}  // namespace

TriangleSurface box_surface(const BoxShape& box) {
  const Vec3 &a = box.lower, &b = box.upper;
  return prism({{a.x(), a.y()}, {b.x(), a.y()}, {b.x(), b.y()}, {a.x(), b.y()}}, a.z(), b.z());
}

TriangleSurface sphere_surface(const SphereShape& sphere) {
  constexpr int kBands = 30;
  std::vector<Vec2> profile;
  for (int k = 0; k <= kBands; ++k) {
    const double angle = std::numbers::pi * k / kBands;
    profile.emplace_back(-sphere.radius * std::cos(angle), sphere.radius * std::sin(angle));
  }
  return turned(profile, sphere.center, Vec3::UnitY());
}

TriangleSurface cylinder_surface(const CylinderShape& cylinder) {
  const Vec3 axis = cylinder.to - cylinder.from;
  const double length = axis.norm();
  return turned({{0, 0}, {0, cylinder.radius}, {length, cylinder.radius}, {length, 0}}, cylinder.from,
                axis / length);
}

TriangleSurface basin_surface(const BasinShape& basin) {
  const Vec3 t = Vec3::Constant(basin.thickness);
  TriangleSurface surface = box_surface({basin.lower - t, basin.upper + Vec3(t.x(), 0, t.z())});
  const TriangleSurface space = box_surface({basin.lower, basin.upper});
  const int first = static_cast<int>(surface.vertices.size());
  surface.vertices.insert(surface.vertices.end(), space.vertices.begin(), space.vertices.end());
  // Both boxes without their tops, the inner one inside out.
  const auto on_top = [&](const TriangleSurface& s, const Triangle& triangle) {
    return std::ranges::all_of(triangle, [&](int v) { return s.vertices[v].y() == basin.upper.y(); });
  };
  std::erase_if(surface.triangles, [&](const Triangle& triangle) { return on_top(surface, triangle); });
  for (const Triangle& t3 : space.triangles)
    if (!on_top(space, t3)) surface.triangles.push_back({first + t3[0], first + t3[2], first + t3[1]});
  // The rim joins the two tops, corner by corner in the order of prism(): 4 and 6 at lower z, 5 and 7 at
  // upper z.
  const std::array<int, 4> corner{4, 6, 7, 5};
  for (int k = 0; k < 4; ++k) {
    const int a = corner[k], b = corner[(k + 1) % 4];
    surface.triangles.push_back({a, b, first + b});
    surface.triangles.push_back({a, first + b, first + a});
  }
  return surface;
}

TriangleSurface stairs_surface(const StairsShape& stairs) {
  const Vec3& origin = stairs.origin;
  const double start = origin.x() - (stairs.steps - 1) * stairs.run - stairs.landing;
  const double bottom = origin.y() - stairs.thickness, end = origin.x() + stairs.floor;
  std::vector<Vec2> profile{{start, bottom}, {end, bottom}, {end, origin.y()}};
  for (int riser = 0; riser < stairs.steps; ++riser) {  // upwards from the floor
    const double x = origin.x() - riser * stairs.run, y = origin.y() + riser * stairs.rise;
    profile.emplace_back(x, y);
    profile.emplace_back(x, y + stairs.rise);
  }
  profile.emplace_back(start, origin.y() + stairs.steps * stairs.rise);
  return prism(profile, origin.z() - stairs.width / 2, origin.z() + stairs.width / 2);
}

double surface_area(const BoxShape& box) {
  const Vec3 d = box.upper - box.lower;
  return 2 * (d.x() * d.y() + d.y() * d.z() + d.z() * d.x());
}

double surface_area(const SphereShape& sphere) {
  return 4 * std::numbers::pi * sphere.radius * sphere.radius;
}

double surface_area(const TriangleSurface& surface) {
  return area_and_volume(surface.vertices, surface.triangles).area;
}

double lattice_size(const BoxShape& box, double spacing) {
  return whole_cells(box, spacing).prod();
}

double lattice_size(const SphereShape& sphere, double spacing) {
  return std::pow(2 * half_cells(sphere, spacing), 3);
}

double lattice_size(const TriangleSurface& solid, double spacing) {
  return covering_cells(bounding_box(solid), spacing).prod();
}

std::vector<Vec3> lattice_points(const BoxShape& box, double spacing) {
  const Vec3 cells = whole_cells(box, spacing);
  const std::array<std::int64_t, 3> count{std::int64_t(cells[0]), std::int64_t(cells[1]),
                                          std::int64_t(cells[2])};
  return lattice(box.lower + Vec3::Constant(spacing / 2), count, spacing, [](const Vec3&) { return true; });
}

std::vector<Vec3> lattice_points(const SphereShape& sphere, double spacing) {
  const double cells = half_cells(sphere, spacing);
  const auto count = std::int64_t(2 * cells);
  return lattice(sphere.center - Vec3::Constant((cells - 0.5) * spacing), {count, count, count}, spacing,
                 [&](const Vec3& x) { return (x - sphere.center).norm() <= sphere.radius * (1 + kWhole); });
}

std::vector<Vec3> lattice_points(const TriangleSurface& solid, double spacing) {
  const BoxShape box = bounding_box(solid);
  const Vec3 cells = covering_cells(box, spacing);
  const std::vector<SolidDistance> solids = solid_distances({&solid, 1});
  return lattice(box.lower + Vec3::Constant(spacing / 2),
                 {std::int64_t(cells[0]), std::int64_t(cells[1]), std::int64_t(cells[2])}, spacing,
                 [&](const Vec3& x) { return nearest_of_union(solids, x).distance < 0; });
}

}  // namespace kappaflow
