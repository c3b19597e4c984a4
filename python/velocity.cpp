#include "python/velocity.h"

#include <fmt/format.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <memory>
#include <string>

#include "core/errors.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/field_handle.h"
#include "surface/mesh/mesh_measures.h"
#include "surface/motion/velocity_methods.h"

namespace kappaflow::python {
namespace {

/// The field for the time of a call.
class LentField {
 public:
  explicit LentField(const Field& field)
      : handle_(nb::cast(FieldHandle(std::shared_ptr<const Field>(&field, [](const Field*) {})))) {}
  ~LentField() { nb::cast<FieldHandle&>(handle_).take_back(); }
  LentField(const LentField&) = delete;
  LentField& operator=(const LentField&) = delete;

  const nb::object& handle() const { return handle_; }

 private:
  nb::object handle_;
};

void call(nb::handle method, const Field& field, const SurfacePoints& points, const VelocityOptions& options,
          VelocitySpans result) {
  const nb::gil_scoped_acquire lock;
  const LentField lent(field);
  PointsHandle copy{{points.position.begin(), points.position.end()},
                    {points.area.begin(), points.area.end()},
                    points.rings};
  const nb::object answer = method(lent.handle(), std::move(copy), options);
  const auto [velocity, confidence] = nb::cast<std::pair<VectorsIn, NumbersIn>>(answer);
  std::ranges::copy(entries<Vec3>(velocity), result.velocity.begin());
  std::ranges::copy(entries<double>(confidence), result.confidence.begin());
}

PointsHandle points_with(const VectorsIn& position, const TrianglesIn& triangles) {
  PointsHandle points;
  points.position = copied<Vec3>(position);
  points.area = vertex_areas(points.position, entries<Triangle>(triangles));
  points.rings = vertex_rings(points.position.size(), entries<Triangle>(triangles));
  return points;
}

template <class Entry>
nb::ndarray<nb::numpy, const Entry, nb::shape<-1>> view(const std::vector<Entry>& values, nb::handle owner) {
  return {values.data(), {values.size()}, owner};
}

}  // namespace

SurfaceMethod surface_method(const nb::object& method) {
  if (!nb::isinstance<nb::str>(method)) return velocity_function(method);
  const std::string name = nb::cast<std::string>(method);
  return surface_methods_named({&name, 1}).front();
}

VelocityFunction velocity_function(const nb::object& method) {
  if (nb::isinstance<nb::str>(method)) return velocity_method(nb::cast<std::string>(method)).evaluate;
  return [method = nb::handle(method)](const Field& field, const SurfacePoints& points,
                                       const VelocityOptions& options, VelocitySpans result) {
    call(method, field, points, options, result);
  };
}

void bind_velocity(nb::module_& m) {
  nb::class_<VelocityOptions>(m, "VelocityOptions", "Options of the velocity methods.")
      .def(nb::init<double, double>(), nb::arg("damping"), nb::arg("speed_limit"))
      .def_ro("damping", &VelocityOptions::damping, "lambda of the damped least squares [1].")
      .def_ro("speed_limit", &VelocityOptions::speed_limit,
              "Of velocities, over the fastest speed in reach [1].");

  using Points = nb::pointer_and_handle<PointsHandle>;
  nb::class_<PointsHandle>(m, "SurfacePoints",
                           "Points on a surface, as a velocity method is given them; arrays are views.")
      .def_prop_ro(
          "positions",
          [](Points self) {
            return nb::ndarray<nb::numpy, const double, nb::shape<-1, 3>>(
                self.p->position.data(), {self.p->position.size(), 3}, self.h);
          },
          "(n, 3) [m].")
      .def_prop_ro(
          "areas", [](Points self) { return view(self.p->area, self.h); },
          "(n,) a third of the area of the triangles around each point [m2].")
      .def_prop_ro(
          "ring_starts", [](Points self) { return view(self.p->rings.start, self.h); },
          "(n + 1,) where the neighbours of each point begin in `neighbours`.")
      .def_prop_ro(
          "neighbours", [](Points self) { return view(self.p->rings.neighbour, self.h); },
          "Those of point v are neighbours[ring_starts[v]:ring_starts[v + 1]], ascending.");
  m.def("surface_points", points_with, nb::arg("positions"), nb::arg("triangles"));

  m.def("velocity_methods", [] {
    nb::typed<nb::dict, nb::str, nb::str> summaries;
    for (const VelocityMethod& method : velocity_methods())
      summaries[nb::str(method.name.data(), method.name.size())] =
          nb::str(method.summary.data(), method.summary.size());
    return summaries;
  });
}

}  // namespace kappaflow::python
