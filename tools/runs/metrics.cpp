#include "tools/runs/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <concepts>
#include <sstream>
#include <string_view>

#include "core/errors.h"
#include "core/parallel.h"
#include "core/solid_distance.h"
#include "core/text_scanner.h"
#include "surface/field/projection.h"
#include "surface/mesh/isosurface.h"
#include "surface/mesh/self_intersection.h"
#include "surface/topology/winding_numbers.h"
#include "tools/io/files.h"
#include "tools/io/point_data.h"

namespace kappaflow {
namespace {

constexpr double kIsosurfaceSpacing = 0.25;                 // of the fresh extraction, in sigma
constexpr double kSmallestAngle = 15, kLargestAngle = 140;  // of a triangle in good order [degrees]

std::string optional_number(const std::optional<double>& value) {
  return value ? fmt::format("{:.12g}", *value) : std::string();
}

/// Takes the cells of a line one after the other.
class RowReader {
 public:
  explicit RowReader(std::string_view line) : rest_(line) {}

  template <class... Values>
  void read(Values&... values) {
    (take(values), ...);
  }
  bool at_end() const { return at_end_; }

 private:
  std::string_view cell() {
    if (at_end_) throw InvalidInput("has too few cells");
    const std::size_t end = rest_.find(',');
    at_end_ = end == std::string_view::npos;
    const std::string_view found = rest_.substr(0, end);
    rest_.remove_prefix(at_end_ ? rest_.size() : end + 1);
    return found;
  }
  void take(std::string& text) { text = cell(); }
  void take(double& number) { number = number_from(cell()); }
  void take(std::optional<double>& number) {
    const std::string_view found = cell();
    if (!found.empty()) number = number_from(found);
  }
  template <std::integral Count>
  void take(Count& count) {
    const std::string_view found = cell();
    const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), count);
    if (error != std::errc() || end != found.data() + found.size())
      throw InvalidInput(fmt::format("has \"{}\" for a whole number", one_line(found, 30)));
  }

  std::string_view rest_;
  bool at_end_ = false;
};

MetricsRow parse_metrics_row(std::string_view line) {
  MetricsRow row;
  FrameMetrics& f = row.frame;
  SurfaceMetrics& s = row.surface;
  RowReader cells(line);
  cells.read(f.frame, f.time, row.method, f.particles, f.penetration_max, f.density_error_mean,
             f.density_error_max);
  cells.read(s.vertices, s.triangles, s.residual_max, s.quality.min, s.quality.mean, s.size.area,
             s.size.volume, f.isosurface_volume);
  cells.read(s.slip, s.rotation_captured, s.tracer_distance, s.topology.components, s.topology.genus,
             f.isosurface.components, f.isosurface.genus, s.kept_fraction, s.unprojected, s.folded_fraction);
  cells.read(s.angles_outside, s.self_intersections, s.texture.mean, s.texture.cracks, s.kept_since_frame,
             s.surface_without_mesh, s.mesh_without_surface, s.regions_replaced, s.regions_refused,
             s.on_lattice.components, s.on_lattice.genus, s.vertices_replaced);
  if (!cells.at_end()) throw InvalidInput("has too many cells");
  return row;
}

/// The largest distance between a fresh isosurface and a mesh, each way [sigma]; 0 where one is empty.
void measure_distances(const Field& field, const TriangleMesh& isosurface, const TriangleMesh& mesh,
                       SurfaceMetrics& metrics) {
  if (isosurface.triangles.empty() || mesh.triangles.empty()) return;
  const double sigma = field.length_scale();
  const SolidDistance to_mesh(TriangleSurface{mesh.position, mesh.triangles}),
      to_isosurface(TriangleSurface{isosurface.position, isosurface.triangles});
  metrics.surface_without_mesh = parallel_max(isosurface.vertex_count(), 0.0, [&](std::size_t v) {
    return std::abs(to_mesh.nearest(isosurface.position[v]).distance) / sigma;
  });
  // The isosurface's chords are off f = 0, and a projection may miss the nearest point or fail.
  metrics.mesh_without_surface = parallel_max(mesh.triangles.size(), 0.0, [&](std::size_t t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3 centroid = (mesh.position[a] + mesh.position[b] + mesh.position[c]) / 3;
    const Projected projected = project(field, centroid, {});
    const double to_chords = std::abs(to_isosurface.nearest(centroid).distance);
    return (projected.converged ? std::min(to_chords, (projected.position - centroid).norm()) : to_chords) /
           sigma;
  });
}

}  // namespace

double penetration_max(std::span<const Vec3> position, const WallDistance& walls, double spacing) {
  return parallel_max(position.size(), 0.0, [&](std::size_t i) { return walls.depth(position[i]); }) /
         spacing;
}

Compression compression(std::span<const float> density, double rest_density) {
  const std::size_t n = density.size();
  const auto of = [&](std::size_t i) {
    return std::max(static_cast<double>(density[i]) / rest_density - 1, 0.0);
  };
  return {parallel_sum(n, 0.0, of) / static_cast<double>(n), parallel_max(n, 0.0, of)};
}

TriangleMesh measure_isosurface(const Field& field, double sigma, FrameMetrics& metrics) {
  TriangleMesh mesh = extract_isosurface(field, kIsosurfaceSpacing * sigma);
  metrics.isosurface_volume = area_and_volume(mesh.position, mesh.triangles).volume;
  metrics.isosurface = mesh_topology(mesh.position, mesh.triangles);
  place_on_surface(field, kIsosurfaceSpacing * sigma, ProjectionOptions{}.tolerance * sigma, mesh.position);
  return mesh;
}

double surface_residual(const Field& field, const TriangleMesh& mesh) {
  const auto residual = [&](std::size_t v) {
    if (mesh.unprojected[v]) return 0.0;
    const ValueAndGradient at = field.value_and_gradient(mesh.position[v]);
    return std::abs(at.f) / (at.g.norm() * field.length_scale());
  };
  return parallel_max(mesh.vertex_count(), 0.0, residual);
}

SurfaceMetrics surface_metrics(const Field& field, const TriangleMesh& isosurface, const TriangleMesh& mesh,
                               const SurfaceState& state, const Vec3& report_axis) {
  SurfaceMetrics metrics;
  metrics.vertices = mesh.vertex_count();
  metrics.triangles = mesh.triangles.size();
  metrics.residual_max = surface_residual(field, mesh);
  metrics.quality = triangle_qualities(mesh.position, mesh.triangles);
  metrics.size = area_and_volume(mesh.position, mesh.triangles);
  metrics.slip = slip(state);
  metrics.pieces = rotation_by_piece(mesh, state, report_axis);
  metrics.rotation_captured = largest_piece_rotation(metrics.pieces);
  metrics.topology = mesh_topology(mesh.position, mesh.triangles);
  metrics.unprojected = static_cast<std::size_t>(std::ranges::count(mesh.unprojected, char{1}));
  metrics.folded_fraction = folded_fraction(mesh.position, state.normal, mesh.triangles);
  metrics.angles_outside = angles_outside(mesh.position, mesh.triangles, kSmallestAngle, kLargestAngle);
  metrics.self_intersections = self_intersections(mesh.position, mesh.triangles);
  metrics.texture = texture_jumps(mesh);
  const SampledField lattice = isosurface_lattice(field, kIsosurfaceSpacing * field.length_scale());
  const TriangleMesh seen = seen_by_lattice(mesh, lattice);
  metrics.on_lattice = mesh_topology(seen.position, seen.triangles);
  measure_distances(field, isosurface, mesh, metrics);
  return metrics;
}

bool SurfaceMetrics::sound(const FrameMetrics& frame) const {
  return unprojected == 0 && folded_fraction <= kSoundFolded &&
         std::abs(size.volume - frame.isosurface_volume) <= kSoundVolume * frame.isosurface_volume &&
         topology.components == frame.isosurface.components && topology.genus == frame.isosurface.genus;
}

std::string metrics_header() {
  return "frame,time,method,particles,penetration_max,density_error_mean,density_error_max,vertices,"
         "triangles,"
         "residual_max,quality_min,quality_mean,area,volume,isosurface_volume,slip,rotation_captured,tracer_"
         "distance,"
         "components,genus,isosurface_components,isosurface_genus,kept_fraction,unprojected,folded_"
         "fraction,angles_outside,self_intersections,texture_jump,texture_cracks,kept_since_frame,"
         "surface_without_mesh,mesh_without_surface,regions_replaced,regions_refused,components_on_lattice,"
         "genus_on_lattice,vertices_replaced\n";
}

std::string metrics_row(const FrameMetrics& f, const std::string& method, const SurfaceMetrics& s) {
  return fmt::format("{},{:.12g},{},{},{},{},{},", f.frame, f.time, method, f.particles,
                     optional_number(f.penetration_max), optional_number(f.density_error_mean),
                     optional_number(f.density_error_max)) +
         fmt::format("{},{},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g},", s.vertices, s.triangles,
                     s.residual_max, s.quality.min, s.quality.mean, s.size.area, s.size.volume,
                     f.isosurface_volume) +
         fmt::format("{},{},{},{},{},{},{},{:.12g},{},{:.12g},", optional_number(s.slip),
                     optional_number(s.rotation_captured), optional_number(s.tracer_distance),
                     s.topology.components, s.topology.genus, f.isosurface.components, f.isosurface.genus,
                     s.kept_fraction, s.unprojected, s.folded_fraction) +
         fmt::format("{:.12g},{},{:.12g},{:.12g},{:.12g},{:.12g},{:.12g},{},{},{},{},{}\n", s.angles_outside,
                     s.self_intersections, s.texture.mean, s.texture.cracks, s.kept_since_frame,
                     s.surface_without_mesh, s.mesh_without_surface, s.regions_replaced, s.regions_refused,
                     s.on_lattice.components, s.on_lattice.genus, s.vertices_replaced);
}

std::vector<MetricsRow> read_metrics(const std::filesystem::path& file) {
  std::istringstream lines(read_file(file));
  std::string line;
  if (!std::getline(lines, line) || line + '\n' != metrics_header())
    throw IoError(file.string(), "is not a table of metrics of this version of kappaflow");
  std::vector<MetricsRow> rows;
  while (std::getline(lines, line)) try {
      rows.push_back(parse_metrics_row(line));
    } catch (const InvalidInput& error) {
      throw IoError(file.string(), fmt::format("row {} {}", rows.size() + 1, error.what()));
    }
  return rows;
}

std::string pieces_header() {
  return "frame,time,method,piece,vertices,rotation_captured\n";
}

std::string pieces_rows(const FrameMetrics& f, const std::string& method, const SurfaceMetrics& s) {
  std::string rows;
  for (std::size_t p = 0; p < s.pieces.size(); ++p)
    rows += fmt::format("{},{:.12g},{},{},{},{}\n", f.frame, f.time, method, p, s.pieces[p].vertices,
                        optional_number(s.pieces[p].captured));
  return rows;
}

}  // namespace kappaflow
