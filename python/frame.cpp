#include "python/frame.h"

#include <algorithm>
#include <variant>

namespace kappaflow::python {
namespace {

void put_state(nb::dict& arrays, SurfaceState& state) {
  arrays["Normals"] = vectors_of(std::move(state.normal));
  arrays["velocity"] = vectors_of(std::move(state.motion.velocity));
  arrays["confidence"] = array_of<double>(std::move(state.motion.confidence));
  arrays["mean_curvature"] = array_of<double>(std::move(state.mean_curvature));
  arrays["gaussian_curvature"] = array_of<double>(std::move(state.gaussian_curvature));
  arrays["area"] = array_of<double>(std::move(state.area));
  if (state.material_slip.empty()) return;
  arrays["material_velocity"] = vectors_of(std::move(state.material_velocity));
  arrays["material_slip"] = array_of<double>(std::move(state.material_slip));
}

void put_added(nb::dict& arrays, const std::string& name, std::vector<double>& values) {
  arrays[name.c_str()] = array_of<double>(std::move(values));
}
void put_added(nb::dict& arrays, const std::string& name, std::vector<Vec3>& values) {
  arrays[name.c_str()] = vectors_of(std::move(values));
}
void put_added(nb::dict& arrays, const std::string& name, std::vector<int>& values) {
  arrays[name.c_str()] = array_of<int>(std::move(values));
}

}  // namespace

SurfaceSnapshot snapshot(const TrackedSurfaces& surfaces, std::size_t surface) {
  return {surfaces.time(), surfaces.mesh(surface), surfaces.state(surface)};
}

NamedArrays arrays_of(SurfaceSnapshot snapshot) {
  TriangleMesh& mesh = snapshot.mesh;
  NamedArrays arrays;
  arrays["positions"] = vectors_of(std::move(mesh.position));
  arrays["triangles"] = array_of<int, 3>(std::move(mesh.triangles));
  put_state(arrays, snapshot.state);
  arrays["rest_position"] = vectors_of(std::move(mesh.rest_position));
  if (std::ranges::any_of(mesh.source, [](int s) { return s != kUnknownSource; }))
    arrays["source"] = array_of<int>(std::move(mesh.source));
  arrays["id"] = array_of<std::int64_t>(std::move(mesh.id));
  arrays["unprojected"] = array_of<unsigned char>(std::move(mesh.unprojected));
  for (VertexArray& added : mesh.added)
    std::visit([&](auto& of) { put_added(arrays, added.name, of.values); }, added.data);
  return arrays;
}

}  // namespace kappaflow::python
