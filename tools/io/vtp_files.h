// VTK data of particles, surfaces and boundaries, and the .vtp files that ParaView opens.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/solids.h"
#include "surface/measure/surface_state.h"
#include "surface/measure/texture.h"
#include "tools/io/particle_frame.h"

namespace kappaflow {

/// Point arrays velocity, density, pressure, temperature, source, id, weight and sigma, as far as they are
/// known; every particle is a vertex cell, so that ParaView shows it. weight: w_i of Eq. 12, one a particle,
/// or none; sigma: its support radius [m]. The last two let `kappaflow probe` read the file.
vtkSmartPointer<vtkPolyData> particle_data(const ParticleFrame& frame, std::span<const double> weight = {},
                                           double sigma = 0);

/// What one surface file holds; one entry a vertex in every array, or none where a span is empty.
struct SurfaceFrame {
  double time;  ///< [s]
  const TriangleMesh& mesh;
  const SurfaceState& state;
  std::optional<Checker> checker{};
  std::span<const Vec2> texture_coordinates{};
};

/// Point arrays Normals and, where they are given, TCoords (both active), velocity, mean_curvature,
/// gaussian_curvature, confidence, rest_position, source (where that of any vertex is known), id (of a vertex
/// for as long as it lives), checker (its cubes as field arrays checker_origin and checker_edge),
/// material_slip (where the material velocity is known), unprojected, and the mesh's added arrays.
vtkSmartPointer<vtkPolyData> surface_data(const SurfaceFrame& frame);

/// All walls as one surface; cell array wall = index of the wall.
vtkSmartPointer<vtkPolyData> boundary_data(std::span<const TriangleSurface> walls);

/// The text of a .pvtp file. like: polydata with the arrays at points that the pieces have; pieces: their
/// names, relative to it.
std::string pvtp_text(vtkPolyData& like, std::span<const std::string> pieces);

/// Writes VTK XML, inline binary, compressed by zlib: the form that every ParaView from 5.0 on reads. Throws
/// IoError.
void write_vtp(const std::filesystem::path& path, vtkPolyData& data);

}  // namespace kappaflow
