// Particles and options, as Python gives them.
#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/errors.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/velocity.h"
#include "surface/tracker/tracked_surfaces.h"

namespace kappaflow::python {
namespace {

Particles particles(double time, const IdsIn& id, const VectorsIn& position, const VectorsIn& velocity,
                    const NumbersIn& scale) {
  return {time, copied<std::int64_t>(id), copied<Vec3>(position), copied<Vec3>(velocity),
          copied<double>(scale)};
}

/// What a name stands for; option: whose it is, for errors.
template <class T, std::size_t N>
T value_named(const Named<T> (&table)[N], const char* option, const std::string& name) {
  if (const std::optional<T> value = value_of(table, name)) return *value;
  std::vector<std::string_view> allowed;
  for (const Named<T>& named : table) allowed.push_back(named.name);
  throw InvalidInput(fmt::format("{}: '{}'; allowed are {}", option, name, fmt::join(allowed, ", ")));
}

/// sigma: [m]; empty: usual_sigma() spacings of the particles, which are measured then.
SurfaceOptions field_choices(std::optional<double> sigma, std::optional<double> threshold,
                             const std::string& weights, const std::string& kernels) {
  SurfaceOptions options;
  options.kernels = value_named(kKernels, "kernels", kernels);
  options.sigma = sigma.value_or(usual_sigma(options.kernels));
  if (sigma) options.spacing = 1;
  options.threshold = threshold;
  options.weights = value_named(kWeightRules, "weights", weights);
  return options;
}

SurfaceOptions surface_choices(SurfaceOptions options, const std::vector<nb::object>& methods,
                               const std::string& anchor, bool is_cloud, double edge_length, bool remesh,
                               bool topology, double motion_per_step, const VelocityOptions& velocity) {
  for (const nb::object& method : methods) options.velocities.push_back(surface_method(method));
  options.anchor = value_named(kAnchors, "anchor", anchor);
  options.is_cloud = is_cloud;
  options.edge_length = edge_length;
  options.remesh = remesh;
  options.topology = topology;
  options.motion_per_step = motion_per_step;
  options.tracker.velocity = velocity;
  return options;
}

}  // namespace

void bind_inputs(nb::module_& m) {
  nb::class_<Particles>(m, "Particles")
      .def(nb::new_(&particles), nb::arg("time"), nb::arg("ids"), nb::arg("positions"), nb::arg("velocities"),
           nb::arg("scales"));
  nb::class_<SurfaceOptions>(m, "SurfaceOptions");
  m.def("field_choices", field_choices, nb::arg("sigma").none(), nb::arg("threshold").none(),
        nb::arg("weights"), nb::arg("kernels"));
  m.def("surface_choices", surface_choices, nb::arg("options"), nb::arg("methods"), nb::arg("anchor"),
        nb::arg("is_cloud"), nb::arg("edge_length"), nb::arg("remesh"), nb::arg("topology"),
        nb::arg("motion_per_step"), nb::arg("velocity"));
}

}  // namespace kappaflow::python
