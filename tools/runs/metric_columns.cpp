#include <fmt/format.h>

#include <concepts>
#include <limits>

#include "core/errors.h"
#include "core/parse_number.h"
#include "core/text_scanner.h"
#include "tools/io/point_data.h"
#include "tools/runs/metrics.h"

namespace kappaflow {
namespace {

std::string cell_of(const std::string& text) {
  return text;
}
std::string cell_of(std::integral auto count) {
  return fmt::format("{}", count);
}
std::string cell_of(double number) {
  return fmt::format("{:.12g}", number);
}
std::string cell_of(const std::optional<double>& number) {
  return number ? cell_of(*number) : std::string();
}

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

double number_of(const std::string&) {
  return kNoNumber;
}
double number_of(std::integral auto count) {
  return static_cast<double>(count);
}
double number_of(double number) {
  return number;
}
double number_of(const std::optional<double>& number) {
  return number.value_or(kNoNumber);
}

void read_cell(std::string_view cell, std::string& text) {
  text = cell;
}
void read_cell(std::string_view cell, double& number) {
  number = number_from(cell);
}
void read_cell(std::string_view cell, std::optional<double>& number) {
  if (!cell.empty()) number = number_from(cell);
}
template <std::integral Count>
void read_cell(std::string_view cell, Count& count) {
  const std::optional<Count> found = parse_number<Count>(cell);
  if (!found) throw InvalidInput(fmt::format("has \"{}\" for a whole number", one_line(cell, 30)));
  count = *found;
}

/// The value at the end of the way from a row through members, some of them optional; null where one is not
/// there.
template <auto Member, auto... Rest, class From>
constexpr auto* end_of_way(const From& from) {
  const auto& member = from.*Member;
  if constexpr (sizeof...(Rest) == 0)
    return &member;
  else if constexpr (requires { *member; })
    return member ? end_of_way<Rest...>(*member) : nullptr;
  else
    return end_of_way<Rest...>(member);
}

/// Reads it, and makes what is optional on the way where the cell has a value.
template <auto Member, auto... Rest, class To>
void read_at_end(std::string_view cell, To& to) {
  auto& member = to.*Member;
  if constexpr (sizeof...(Rest) == 0) {
    read_cell(cell, member);
  } else if constexpr (requires { *member; }) {
    if (cell.empty()) return;
    if (!member) member.emplace();
    read_at_end<Rest...>(cell, *member);
  } else {
    read_at_end<Rest...>(cell, member);
  }
}

/// Members: the way from a row to the value.
template <auto... Members>
constexpr MetricColumn column(std::string_view name, std::string_view unit, Better better,
                              std::string_view meaning) {
  return {name,
          unit,
          meaning,
          better,
          [](const MetricsRow& row) {
            const auto* const value = end_of_way<Members...>(row);
            return value == nullptr ? std::string() : cell_of(*value);
          },
          [](const MetricsRow& row) -> double {
            const auto* const value = end_of_way<Members...>(row);
            return value == nullptr ? kNoNumber : number_of(*value);
          },
          [](std::string_view cell, MetricsRow& row) { read_at_end<Members...>(cell, row); }};
}

/// Of a frame: FrameMetrics.
template <auto... Members>
constexpr MetricColumn of_frame(std::string_view name, std::string_view unit, std::string_view meaning) {
  return column<&MetricsRow::frame, Members...>(name, unit, Better::neither, meaning);
}
/// Of a method: SurfaceMetrics.
template <auto... Members>
constexpr MetricColumn of_surface(std::string_view name, std::string_view unit, Better better,
                                  std::string_view meaning) {
  return column<&MetricsRow::surface, Members...>(name, unit, better, meaning);
}

using Frame = FrameMetrics;
using Surface = SurfaceMetrics;
using Judgement = SurfaceJudgement;

// What a surface has in common with all others of its frame is better for none of them.
constexpr MetricColumn kColumns[] = {
    of_frame<&Frame::frame>("frame", "1", "number of the frame, from 0"),
    of_frame<&Frame::time>("time", "s", "simulated time"),
    column<&MetricsRow::method>("method", "", Better::neither, "velocity method that the surface moved with"),
    of_frame<&Frame::particles>("particles", "1", "how many there are"),
    of_frame<&Frame::penetration_max>("penetration_max", "spacings",
                                      "depth of the deepest particle centre inside a wall or body"),
    of_frame<&Frame::density_error_mean>("density_error_mean", "1",
                                         "compression max(rho/rho0 - 1, 0), mean over the particles: the "
                                         "largest since the last frame"),
    of_frame<&Frame::density_error_max>("density_error_max", "1",
                                        "compression of the particle that has most: the largest since the "
                                        "last frame"),
    of_frame<&Frame::viscosity_error>("viscosity_error", "1",
                                      "error of the velocities after viscosity over what "
                                      "viscosity_tolerance allows: the largest since the last frame"),
    of_frame<&Frame::temperature_min>("temperature_min", "K",
                                      "of the coldest particle, in a scene with heat"),
    of_frame<&Frame::temperature_mean>("temperature_mean", "K", "mean over the particles"),
    of_frame<&Frame::temperature_max>("temperature_max", "K", "of the hottest particle"),
    of_surface<&Surface::vertices>("vertices", "1", Better::neither, "how many the mesh has"),
    of_surface<&Surface::triangles>("triangles", "1", Better::neither, "how many the mesh has"),
    of_surface<&Surface::residual_max>(
        "residual_max", "sigma", Better::lower,
        "largest distance abs(f)/abs(grad f) of a projected vertex from f = 0, "
        "after any step since the last frame"),
    of_surface<&Surface::quality, &QualityRange::min>(
        "quality_min", "1", Better::higher,
        "2 inradius/circumradius of the worst triangle; 1 is equilateral"),
    of_surface<&Surface::quality, &QualityRange::mean>("quality_mean", "1", Better::higher,
                                                       "the same, mean over the triangles"),
    of_surface<&Surface::size, &AreaAndVolume::area>("area", "m2", Better::neither, "of the tracked mesh"),
    of_surface<&Surface::size, &AreaAndVolume::volume>("volume", "m3", Better::neither,
                                                       "of the tracked mesh"),
    of_frame<&Frame::isosurface, &IsosurfaceMetrics::volume>(
        "isosurface_volume", "m3", "of a surface freshly extracted at spacing 0.25 sigma"),
    of_surface<&Surface::slip>("slip", "1", Better::lower,
                               "RMS over the vertices (by area) of the tangential difference to `material`, "
                               "over the RMS tangential speed of `material`"),
    of_surface<&Surface::rotation_captured>("rotation_captured", "1", Better::nearer_to_one,
                                            "angular velocity about the scene's axis of the rigid motion "
                                            "fitted to the largest piece, over the same fitted to "
                                            "`material`"),
    of_surface<&Surface::tracer_distance>("tracer_distance", "sigma", Better::lower,
                                          "mean distance of the first mesh's vertices, as far as they are "
                                          "still there, from material tracers that started where they did"),
    of_surface<&Surface::topology, &MeshTopology::components>("components", "1", Better::neither,
                                                              "pieces of the tracked mesh"),
    of_surface<&Surface::topology, &MeshTopology::genus>("genus", "1", Better::neither,
                                                         "handles of the tracked mesh"),
    of_frame<&Frame::isosurface, &IsosurfaceMetrics::topology, &MeshTopology::components>(
        "isosurface_components", "1", "pieces of the fresh isosurface"),
    of_frame<&Frame::isosurface, &IsosurfaceMetrics::topology, &MeshTopology::genus>(
        "isosurface_genus", "1", "handles of the fresh isosurface"),
    of_surface<&Surface::kept_fraction>("kept_fraction", "1", Better::higher,
                                        "share of the first mesh's vertices that are still there"),
    of_surface<&Surface::unprojected>("unprojected", "1", Better::lower, "vertices that are not on f = 0"),
    of_surface<&Surface::folded_fraction>("folded_fraction", "1", Better::lower,
                                          "share of the triangles that have folded over: they face away "
                                          "from the field's outward normals"),
    of_surface<&Surface::angles_outside>(
        "angles_outside", "1", Better::lower,
        "share of the triangles with an angle below 15 or above 140 degrees"),
    of_surface<&Surface::judgement, &Judgement::self_intersections>(
        "self_intersections", "1", Better::lower,
        "pairs of triangles that pass through each other, those with a "
        "common edge left out"),
    of_surface<&Surface::texture, &TextureJumps::mean>("texture_jump", "1", Better::lower,
                                                       "jump of the gradient of `rest_position` across an "
                                                       "edge, over the gradient: mean over the edges; 2 at "
                                                       "most"),
    of_surface<&Surface::texture, &TextureJumps::cracks>("texture_cracks", "1", Better::lower,
                                                         "share of the edges where that jump is above 1: "
                                                         "the texture is folded, torn or smeared"),
    of_surface<&Surface::texture_distance>(
        "texture_distance", "sigma", Better::lower,
        "mean distance of `rest_position`, at the points of the mesh nearest to the material tracers, from "
        "where these started: for surfaces of any kind"),
    of_surface<&Surface::texture_flicker>(
        "texture_flicker", "sigma", Better::lower,
        "mean change of `rest_position` there since the last frame: 0 where the texture sticks to the "
        "material"),
    of_surface<&Surface::kept_since_frame>("kept_since_frame", "1", Better::higher,
                                           "share of the last frame's vertices that are still there"),
    of_surface<&Surface::judgement, &Judgement::surface_without_mesh>(
        "surface_without_mesh", "sigma", Better::lower,
        "largest distance from the points of f = 0 on the edges of "
        "the fresh isosurface's lattice to the mesh"),
    of_surface<&Surface::judgement, &Judgement::mesh_without_surface>(
        "mesh_without_surface", "sigma", Better::lower,
        "largest distance from the centroids of the mesh's triangles "
        "to f = 0"),
    of_surface<&Surface::regions_replaced>("regions_replaced", "1", Better::neither,
                                           "regions of the mesh that were replaced by the isosurface since "
                                           "the last frame: see [topology.md](topology.md)"),
    of_surface<&Surface::regions_refused>("regions_refused", "1", Better::lower,
                                          "regions where that failed since the last frame"),
    of_surface<&Surface::judgement, &Judgement::on_lattice, &MeshTopology::components>(
        "components_on_lattice", "1", Better::neither,
        "pieces of the tracked mesh as the lattice of the fresh isosurface sees it: what passes between its "
        "points is left out, and counted by the difference to `components`"),
    of_surface<&Surface::judgement, &Judgement::on_lattice, &MeshTopology::genus>(
        "genus_on_lattice", "1", Better::neither, "handles of the same"),
    of_surface<&Surface::vertices_replaced>("vertices_replaced", "1", Better::lower,
                                            "vertices that changes of topology took away since the last "
                                            "frame; `kept_since_frame` counts those that remeshing took as "
                                            "well"),
    of_frame<&Frame::particles_outside>("particles_outside", "1",
                                        "particles outside the surface, f < 0 at their centre: those of a "
                                        "spray that have none of their own"),
    of_frame<&Frame::particles_taken>("particles_taken", "1",
                                      "particles that outflow regions have taken away since the start"),
    of_frame<&Frame::taken_by_region>("taken_by_region", "1",
                                      "the same for each region, in the order of the scene file, with spaces "
                                      "between them"),
};

}  // namespace

std::span<const MetricColumn> metric_columns() {
  return kColumns;
}

}  // namespace kappaflow
