#include "tests/surface/motion/staircase_frame.h"

#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkPointData.h>

#include "surface/field/particle_weights.h"
#include "tests/vtk_reader.h"

namespace kappaflow::testing {

namespace {

vtkDataArray& array_of(vtkPolyData& frame, const char* name) {
  vtkDataArray* array = frame.GetPointData()->GetArray(name);
  if (array == nullptr) throw std::runtime_error(fmt::format("the frame has no array {}", name));
  return *array;
}

}  // namespace

Body read_staircase_frame(int number) {
  const auto frame = read_vtp(
      fmt::format("{}/scenes/experiments/data/staircase_frame_{:02}.vtp", KAPPAFLOW_SOURCE_DIR, number));
  vtkDataArray &velocity = array_of(*frame, "velocity"), &sigma = array_of(*frame, "sigma"),
               &weight = array_of(*frame, "weight");
  Body body;
  FieldParticles& particles = body.particles;
  for (vtkIdType i = 0; i < frame->GetNumberOfPoints(); ++i) {
    particles.position.emplace_back(frame->GetPoint(i));
    particles.velocity.emplace_back(velocity.GetTuple3(i));
    particles.sigma.push_back(sigma.GetTuple1(i));
    particles.weight.push_back(weight.GetTuple1(i));
    particles.weight_rate.push_back(0);
  }
  body.threshold = half_median_threshold(particles.position, particles.weight, particles.sigma.front());
  return body;
}

}  // namespace kappaflow::testing
