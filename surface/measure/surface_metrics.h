// How well a tracked surface does at one instant, as numbers.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "surface/field/field.h"
#include "surface/measure/surface_state.h"
#include "surface/measure/texture_jumps.h"
#include "surface/mesh/mesh_measures.h"

namespace kappaflow {

/// What a fresh extraction of f = 0 at 0.25 sigma says of the surface: the same for all methods.
struct IsosurfaceMetrics {
  double volume = 0;  ///< [m3]
  MeshTopology topology;
};

struct FreshIsosurface {
  TriangleMesh mesh;  ///< its vertices moved onto f = 0 along the lattice's edges
  IsosurfaceMetrics metrics;
};

/// sigma [m].
FreshIsosurface fresh_isosurface(const Field& field, double sigma);

/// What a fresh isosurface and a search for triangles that meet say of a mesh: the numbers that cost time.
struct SurfaceJudgement {
  std::size_t self_intersections = 0;  ///< see self_intersections()
  MeshTopology on_lattice;             ///< of what the fresh isosurface's lattice sees: seen_by_lattice()
  /// Largest distance from the points of f = 0 on the edges of the fresh isosurface's lattice to the mesh
  /// [sigma].
  double surface_without_mesh = 0;
  /// Largest distance from the centroids of the mesh's triangles to f = 0 or the fresh isosurface, whichever
  /// is nearer [sigma].
  double mesh_without_surface = 0;
};

/// Numbers of one tracked surface.
struct SurfaceMetrics {
  std::size_t vertices = 0, triangles = 0;
  double residual_max = 0;  ///< see surface_residual(); with those of the steps since the last frame
  QualityRange quality;
  AreaAndVolume size;
  std::optional<double> slip;               ///< see slip()
  std::vector<PieceRotation> pieces;        ///< see rotation_by_piece()
  std::optional<double> rotation_captured;  ///< of the largest piece
  std::optional<double> tracer_distance;    ///< mean distance of a vertex from its material tracer, in sigma
  std::optional<double> texture_distance;   ///< see texture_distance()
  std::optional<double> texture_flicker;    ///< see texture_flicker()
  MeshTopology topology;
  double kept_fraction = 1;           ///< share of the first mesh's vertices that are still there
  std::size_t unprojected = 0;        ///< vertices that are not on the surface
  double folded_fraction = 0;         ///< see folded_fraction()
  double angles_outside = 0;          ///< share of the triangles with an angle below 15 or above 140 degrees
  TextureJumps texture;               ///< see texture_jumps()
  double kept_since_frame = 1;        ///< share of the last frame's vertices that are still there
  std::size_t regions_replaced = 0;   ///< TopologyCounts::replaced since the last frame
  std::size_t regions_refused = 0;    ///< likewise
  std::size_t vertices_replaced = 0;  ///< TopologyCounts::vertices_lost since the last frame
  std::optional<SurfaceJudgement> judgement;

  /// Whether the mesh stands for the surface at all: every vertex on it, hardly a triangle folded over, the
  /// volume and the topology of a fresh isosurface.
  bool sound(const IsosurfaceMetrics& isosurface) const;
};

inline constexpr double kSoundFolded = 1e-3;  ///< largest share of folded triangles of a sound mesh
inline constexpr double kSoundVolume = 0.02;  ///< largest relative difference of its volume

/// max |f| / (|g| L) over the projected vertices: their distance from f = 0 in units of L =
/// Field::length_scale().
double surface_residual(const Field& field, const TriangleMesh& mesh);

/// How many of the points are outside the surface, f < 0: of particles, those that have none.
std::size_t points_outside(const Field& field, std::span<const Vec3> points);

/// Everything that mesh and state say; judgement, tracer_distance, texture_distance, texture_flicker,
/// kept_fraction, kept_since_frame, vertices_replaced and regions_* are the caller's. report_axis: a unit
/// vector.
SurfaceMetrics surface_metrics(const Field& field, const TriangleMesh& mesh, const SurfaceState& state,
                               const Vec3& report_axis);

/// isosurface: FreshIsosurface::mesh of the same field.
SurfaceJudgement judge_surface(const Field& field, const TriangleMesh& isosurface, const TriangleMesh& mesh);

}  // namespace kappaflow
