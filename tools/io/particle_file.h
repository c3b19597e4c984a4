// Particles of a field from a file.
#pragma once

#include <filesystem>

#include "surface/field/particle_field.h"

namespace kappaflow {

/// Reads .vtp with the point arrays velocity (3), weight (1) and sigma (1), or .csv with the header
/// x,y,z,vx,vy,vz,weight,sigma. Throws InvalidInput, IoError.
FieldParticles read_particle_file(const std::filesystem::path& file);

}  // namespace kappaflow
