// The numbers of metrics.csv: how well the simulation and each tracked surface do at one frame.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/particles.h"
#include "scenes/wall_distance.h"
#include "surface/field/field.h"
#include "surface/measure/surface_state.h"
#include "surface/measure/texture_jumps.h"
#include "surface/mesh/mesh_measures.h"

namespace kappaflow {

/// Numbers that all methods of a frame share.
struct FrameMetrics {
  int frame = 0;
  double time = 0;  ///< [s]
  std::size_t particles = 0;
  std::optional<double> penetration_max;     ///< deepest particle centre inside a solid, in spacings; >= 0
  std::optional<double> density_error_mean;  ///< largest mean compression of a step since the last frame [1]
  std::optional<double> density_error_max;   ///< largest compression of a particle since then [1]
  double isosurface_volume = 0;              ///< of a fresh extraction at 0.25 sigma [m3]
  MeshTopology isosurface;                   ///< of the same
};

/// Numbers of one tracked surface.
struct SurfaceMetrics {
  std::size_t vertices = 0, triangles = 0;
  double residual_max =
      0;  ///< see surface_residual(); the tracker's residuals since the last frame count too
  QualityRange quality;
  AreaAndVolume size;
  std::optional<double> slip;               ///< see slip()
  std::vector<PieceRotation> pieces;        ///< see rotation_by_piece()
  std::optional<double> rotation_captured;  ///< of the largest piece
  std::optional<double> tracer_distance;    ///< mean distance of a vertex from its material tracer, in sigma
  MeshTopology topology;
  /// Of the mesh as the lattice of the fresh isosurface sees it, see seen_by_lattice().
  MeshTopology on_lattice;
  /// Share of the initial mesh's vertices that the mesh still has; the rest fell to edits.
  double kept_fraction = 1;
  std::size_t unprojected = 0;         ///< vertices that are not on the surface
  double folded_fraction = 0;          ///< see folded_fraction()
  double angles_outside = 0;           ///< share of the triangles with an angle below 15 or above 140 degrees
  std::size_t self_intersections = 0;  ///< see self_intersections()
  TextureJumps texture;                ///< see texture_jumps()
  double kept_since_frame = 1;         ///< share of the last frame's vertices that the mesh still has
  std::size_t regions_replaced = 0;    ///< TopologyCounts::replaced since the last frame
  std::size_t regions_refused = 0;     ///< likewise
  std::size_t vertices_replaced = 0;   ///< TopologyCounts::vertices_lost since the last frame
  /// Largest distance from the points of f = 0 on the edges of the fresh isosurface's lattice to the mesh
  /// [sigma].
  double surface_without_mesh = 0;
  /// Largest distance from the centroids of the mesh's triangles to f = 0 or the fresh isosurface, whichever
  /// is nearer [sigma].
  double mesh_without_surface = 0;

  /// Whether the mesh stands for the surface at all: every vertex on it, hardly a triangle folded over, the
  /// volume and the topology of a fresh isosurface.
  bool sound(const FrameMetrics& frame) const;
};

inline constexpr double kSoundFolded = 1e-3;  ///< largest share of folded triangles of a sound mesh
inline constexpr double kSoundVolume = 0.02;  ///< largest relative difference of its volume

/// Depth of the deepest particle centre inside a solid over `spacing` [m]; 0 when all are outside.
double penetration_max(std::span<const Vec3> position, const WallDistance& walls, double spacing);

/// Mean and largest compression max(rho / rho0 - 1, 0) of the particles [1]; rho, rho0 in [kg/m3].
struct Compression {
  double mean = 0, max = 0;
};
Compression compression(std::span<const float> density, double rest_density);

/// Fills the isosurface_* members from an extraction at 0.25 sigma [m], and returns it, its vertices
/// moved onto f = 0 along the lattice's edges.
TriangleMesh measure_isosurface(const Field& field, double sigma, FrameMetrics& metrics);

/// max |f| / (|g| L) over the projected vertices: their distance from f = 0 in units of L =
/// Field::length_scale().
double surface_residual(const Field& field, const TriangleMesh& mesh);

/// Everything that mesh and state say; tracer_distance, kept_fraction, kept_since_frame, vertices_replaced
/// and regions_* are the caller's. isosurface: what measure_isosurface() returns.
SurfaceMetrics surface_metrics(const Field& field, const TriangleMesh& isosurface, const TriangleMesh& mesh,
                               const SurfaceState& state, const Vec3& report_axis);

/// One line each, with the line's end; numbers to 12 digits, empty where there is no value.
std::string metrics_header();
std::string metrics_row(const FrameMetrics& frame, const std::string& method, const SurfaceMetrics& surface);
/// What such a line says.
struct MetricsRow {
  FrameMetrics frame;
  std::string method;
  SurfaceMetrics surface;  ///< without `pieces`
};
/// The rows under the header of such a table, to the digits that it has. Throws IoError where the file cannot
/// be read or holds anything else.
std::vector<MetricsRow> read_metrics(const std::filesystem::path& file);

/// The same of pieces.csv: a line for each connected piece.
std::string pieces_header();
std::string pieces_rows(const FrameMetrics& frame, const std::string& method, const SurfaceMetrics& surface);

}  // namespace kappaflow
