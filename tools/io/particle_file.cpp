#include "tools/io/particle_file.h"

#include <fmt/format.h>

#include <cmath>

#include "core/errors.h"
#include "tools/io/number_table.h"
#include "tools/io/vtk_points.h"

namespace kappaflow {
namespace {

constexpr const char* kParticleHeader = "x,y,z,vx,vy,vz,weight,sigma";
void add_particle(FieldParticles& particles, const Vec3& position, const Vec3& velocity, double weight,
                  double sigma) {
  particles.position.push_back(position);
  particles.velocity.push_back(velocity);
  particles.weight.push_back(weight);
  particles.sigma.push_back(sigma);
  particles.weight_rate.push_back(0);
}

FieldParticles particles_from_csv(const std::filesystem::path& file) {
  FieldParticles particles;
  for (const std::vector<double>& row : read_number_table(file, kParticleHeader))
    add_particle(particles, {row[0], row[1], row[2]}, {row[3], row[4], row[5]}, row[6], row[7]);
  return particles;
}

const PointArray& point_array(const PointData& data, const char* name, std::size_t components,
                              const std::filesystem::path& file) {
  const PointArray* array = find_array(data.arrays, {name}, components);
  if (array == nullptr)
    throw InvalidInput({file.string()},
                       fmt::format("no point array \"{}\" with {} component{}; expected velocity (3), "
                                   "weight (1), sigma (1)",
                                   name, components, components == 1 ? "" : "s"));
  return *array;
}

FieldParticles particles_from_vtp(const std::filesystem::path& file) {
  const PointData data = read_vtk_points(file);
  const PointArray &velocity = point_array(data, "velocity", 3, file),
                   &weight = point_array(data, "weight", 1, file),
                   &sigma = point_array(data, "sigma", 1, file);
  FieldParticles particles;
  for (std::size_t i = 0; i < data.position.size(); ++i)
    add_particle(particles, data.position[i], Vec3(&velocity.values[3 * i]), weight.values[i],
                 sigma.values[i]);
  return particles;
}

void check_values(const FieldParticles& particles, const std::filesystem::path& file) {
  if (particles.position.empty()) throw InvalidInput({file.string()}, "holds no particles");
  for (std::size_t i = 0; i < particles.position.size(); ++i) {
    const double sigma = particles.sigma[i], weight = particles.weight[i];
    if (!particles.position[i].allFinite() || !particles.velocity[i].allFinite() || !std::isfinite(weight) ||
        !std::isfinite(sigma) || !(sigma > 0))
      throw InvalidInput({file.string()},
                         fmt::format("particle number {} has a number that is not finite, or a sigma of {}; "
                                     "expected finite numbers and sigma > 0",
                                     i, sigma));
  }
}

}  // namespace

FieldParticles read_particle_file(const std::filesystem::path& file) {
  const bool csv = file.extension() == ".csv";
  if (!csv && file.extension() != ".vtp")
    throw InvalidInput({file.string()}, "unknown kind of particle file; expected .vtp or .csv");
  FieldParticles particles = csv ? particles_from_csv(file) : particles_from_vtp(file);
  check_values(particles, file);
  return particles;
}

}  // namespace kappaflow
