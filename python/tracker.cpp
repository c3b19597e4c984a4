// TrackedSurfaces, moved on with arrays of particles.
#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <utility>

#include "core/named.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/exclusive.h"
#include "python/frame.h"
#include "surface/measure/surface_motion.h"

namespace kappaflow::python {
namespace {

using Tracker = Exclusive<TrackedSurfaces>;

/// The particles are moved from.
void make_tracker(Tracker* self, Particles& first, const Particles* next, const SurfaceOptions& options) {
  new (self) Tracker("Tracker", [&] {
    return next != nullptr ? TrackedSurfaces(std::move(first), *next, options)
                           : TrackedSurfaces(std::move(first), options);
  });
}

/// Throws InvalidInput where the surface of a point cloud moves too far to be followed.
void check_motion_to(const Particles& next, const TrackedSurfaces& surfaces) {
  ParticleFieldOptions options = surfaces.field_options();
  options.kernels = Kernels::round;  // their surface is where others' is, but for the waves
  const auto before = particle_field(surfaces.particles(), options), after = particle_field(next, options);
  check_cloud_motion("the particles", *before, *after, options.sigma);
}

/// The particles are moved from.
void advance(Tracker& self, Particles& next, bool is_cloud) {
  if (is_cloud) self.use([&](const TrackedSurfaces& surfaces) { check_motion_to(next, surfaces); });
  self.move_on([&](TrackedSurfaces& surfaces) { surfaces.advance(std::move(next)); });
}

NamedArrays surface_arrays(Tracker& self, std::size_t surface) {
  return arrays_of(self.use([&](const TrackedSurfaces& surfaces) { return snapshot(surfaces, surface); }));
}

void find_sources(Tracker& self, const IntegersIn& source) {
  self.use([&](TrackedSurfaces& surfaces) { surfaces.find_sources(entries<int>(source)); });
}

constexpr Named<Carry> kCarries[] = {
    {"interpolate", Carry::interpolate}, {"nearest", Carry::nearest}, {"recompute", Carry::recompute}};

Carry carry_named(const std::string& name) {
  if (const std::optional<Carry> carry = value_of(kCarries, name)) return *carry;
  throw InvalidInput(fmt::format("carry: '{}'; allowed are interpolate, nearest, recompute", name));
}

template <class T>
void add_array(Tracker& self, const std::string& name, const T& fresh, const std::string& carry) {
  self.use([&](TrackedSurfaces& surfaces) { surfaces.add_array<T>(name, carry_named(carry), fresh); });
}

void add_vectors(Tracker& self, const std::string& name, const std::array<double, 3>& fresh,
                 const std::string& carry) {
  add_array(self, name, Vec3(fresh[0], fresh[1], fresh[2]), carry);
}

template <class T, class Array>
void set_array(Tracker& self, const std::string& name, const Array& values, std::size_t surface) {
  self.use([&](TrackedSurfaces& surfaces) {
    const std::span<T> array = surfaces.array<T>(name, surface);
    if (values.shape(0) != array.size())
      throw InvalidInput(
          fmt::format("array '{}': {} values for {} vertices", name, values.shape(0), array.size()));
    std::ranges::copy(entries<T>(values), array.begin());
  });
}

/// What happened since the last call, on each surface.
auto take_report(Tracker& self) {
  nb::typed<nb::list, nb::typed<nb::dict, nb::str, double>> report;
  for (const TrackerStep& step : self.use([](TrackedSurfaces& surfaces) { return surfaces.take_report(); })) {
    nb::dict counts;
    counts["unprojected"] = step.unprojected;
    counts["residual_max"] = step.residual_max;
    counts["regions_replaced"] = step.topology.replaced;
    counts["regions_refused"] = step.topology.refused;
    counts["splits"] = step.edits.splits;
    counts["collapses"] = step.edits.collapses;
    counts["flips"] = step.edits.flips;
    report.append(counts);
  }
  return report;
}

}  // namespace

void bind_tracker(nb::module_& m) {
  nb::class_<Tracker>(m, "TrackerHandle")
      .def("__init__", make_tracker, nb::arg("first"), nb::arg("next").none(), nb::arg("options"))
      .def("advance", advance, nb::arg("next"), nb::arg("is_cloud"))
      .def("surface", surface_arrays, nb::arg("surface"))
      .def("find_sources", find_sources, nb::arg("sources"))
      .def("add_numbers", add_array<double>, nb::arg("name"), nb::arg("fresh"), nb::arg("carry"))
      .def("add_integers", add_array<int>, nb::arg("name"), nb::arg("fresh"), nb::arg("carry"))
      .def("add_vectors", add_vectors, nb::arg("name"), nb::arg("fresh"), nb::arg("carry"))
      .def("set_numbers", set_array<double, NumbersIn>, nb::arg("name"), nb::arg("values"),
           nb::arg("surface"))
      .def("set_integers", set_array<int, IntegersIn>, nb::arg("name"), nb::arg("values"), nb::arg("surface"))
      .def("set_vectors", set_array<Vec3, VectorsIn>, nb::arg("name"), nb::arg("values"), nb::arg("surface"))
      .def("take_report", take_report)
      .def_prop_ro("time",
                   [](Tracker& self) { return self.use([](const TrackedSurfaces& s) { return s.time(); }); })
      .def_prop_ro("sigma",
                   [](Tracker& self) {
                     return self.use([](const TrackedSurfaces& s) { return s.field_options().sigma; });
                   })
      .def_prop_ro("threshold",
                   [](Tracker& self) {
                     return self.use([](const TrackedSurfaces& s) { return s.field_options().threshold; });
                   })
      .def_prop_ro("surfaces", [](Tracker& self) {
        return self.use([](const TrackedSurfaces& s) { return s.count(); });
      });
}

}  // namespace kappaflow::python
