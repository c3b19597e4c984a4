#include "tools/particle_file.h"

#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>

#include "core/errors.h"
#include "tools/data_files.h"
#include "tools/number_table.h"

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

vtkDataArray& point_array(vtkPolyData& data, const char* name, int components,
                          const std::filesystem::path& file) {
  vtkDataArray* array = data.GetPointData()->GetArray(name);
  if (array == nullptr || array->GetNumberOfComponents() != components)
    throw InvalidInput({file.string()},
                       fmt::format("no point array \"{}\" with {} component{}; expected velocity (3), "
                                   "weight (1), sigma (1)",
                                   name, components, components == 1 ? "" : "s"));
  return *array;
}

FieldParticles particles_from_vtp(const std::filesystem::path& file) {
  const vtkSmartPointer<vtkPolyData> data = read_vtp(file);
  vtkDataArray& velocity = point_array(*data, "velocity", 3, file);
  vtkDataArray& weight = point_array(*data, "weight", 1, file);
  vtkDataArray& sigma = point_array(*data, "sigma", 1, file);
  FieldParticles particles;
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i)
    add_particle(particles, Vec3(data->GetPoint(i)), Vec3(velocity.GetTuple3(i)), weight.GetTuple1(i),
                 sigma.GetTuple1(i));
  return particles;
}

}  // namespace

FieldParticles read_particle_file(const std::filesystem::path& file) {
  if (file.extension() == ".csv") return particles_from_csv(file);
  if (file.extension() == ".vtp") return particles_from_vtp(file);
  throw InvalidInput({file.string()}, "unknown kind of particle file; expected .vtp or .csv");
}

}  // namespace kappaflow
