// The particles of one frame that another program wrote.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// Where in the liquid a particle is, by its distance from where the field of Eq. 12 falls below three
/// quarters of what it is inside [sigma], along the axis in which that is largest. See LiquidDepth.
enum class Zone : std::uint8_t {
  surface,  ///< up to 1.5
  middle,   ///< up to 2.5
  inner,    ///< up to 4.5
  deep,     ///< up to 7.5, and stands for those in a cube of a sigma
  deepest,  ///< stands for those in a cube of two sigma
  passing,  ///< in the depth, and is there because the frame before has it
};

/// One entry a particle in every array, in the file's order; arrays that the file lacks are empty.
struct InputFrame {
  std::vector<Vec3> position;                       ///< [m], finite
  std::vector<std::int64_t> id;                     ///< as the file has them: perhaps not unique
  std::vector<Vec3> velocity;                       ///< [m/s], finite
  std::vector<float> density;                       ///< [kg/m3]
  std::vector<float> pressure;                      ///< [Pa]
  std::vector<float> temperature;                   ///< [K]
  std::vector<int> source;                          ///< where it comes from
  std::vector<double> radius;                       ///< of each particle, > 0, by any measure
  std::optional<double> time;                       ///< [s], where the file says it
  std::string id_name, velocity_name, radius_name;  ///< what the file calls them; empty where it lacks them
  std::vector<Zone> zone;    ///< where not all particles are kept, see read_near_surface(); else empty
  std::size_t all = 0;       ///< particles of which these are kept
  double fast_speed = 0;     ///< fast_speed() of them, where only some are kept [m/s]
  std::size_t left_out = 0;  ///< particles of walls, and copies that belong to other processors
};

/// Calls visit(from, to) for each array of the particles.
template <class Visit>
void for_each_array(const InputFrame& from, InputFrame& to, const Visit& visit) {
  visit(from.position, to.position);
  visit(from.id, to.id);
  visit(from.velocity, to.velocity);
  visit(from.density, to.density);
  visit(from.pressure, to.pressure);
  visit(from.temperature, to.temperature);
  visit(from.source, to.source);
  visit(from.radius, to.radius);
}

/// Reads a frame of one file or of several, the pieces that the ranks of a distributed solver wrote: their
/// particles one after the other. By the ending of the name,
///   .vtk       legacy VTK, text or binary, polydata or unstructured grid (SPlisHSPlasH, DualSPHysics)
///   .vtp .vtu  VTK XML (kappaflow, PySPH)
///   .pvtp .pvtu  parallel VTK XML: the pieces that it lists, relative to it
///   .bgeo      Partio's, version 5 (SPlisHSPlasH): id, velocity or v, density, pressure
///   .hdf5      PySPH's own
///   .csv       with the columns x, y, z, perhaps id, vx, vy, vz and radius (see number_table.h)
/// VTK's arrays are known by these names, in upper or lower case: id, ids, idp, gid, particle_id;
/// velocity, vel, v (3 components) or u, v, w or vx, vy, vz; density, rho, rhop; pressure, press, p;
/// temperature, temp; source (only where all are whole numbers); radius, particle_radius, pscale, and h of
/// PySPH's; the field array TimeValue or time. DualSPHysics' particles of walls (beside Idp a Type other than
/// 3) are left out, as are PySPH's remote and ghost particles (tag not 0) and what VTK's arrays vtkGhostType
/// and vtkGhostLevels call duplicate or hidden. Throws IoError (not readable, not complete, a piece is not
/// there), InvalidInput (no particles, a number that is not finite, pieces of different times or arrays).
InputFrame read_input_frame(std::span<const std::filesystem::path> files);
InputFrame read_input_frame(const std::filesystem::path& file);

/// The same piece by piece: calls take(piece) for each, of which some may have no particles, and keeps none.
void for_each_piece(std::span<const std::filesystem::path> files,
                    const std::function<void(InputFrame&& piece)>& take);

/// Whether the ending of the name is one of those.
bool is_particle_file(const std::filesystem::path& file);
inline constexpr const char* kParticleFileKinds = ".vtk, .vtp, .vtu, .pvtp, .pvtu, .bgeo, .hdf5 or .csv";

}  // namespace kappaflow
