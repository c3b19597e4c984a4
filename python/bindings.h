// The parts of the module, a file each.
#pragma once

#include <nanobind/nanobind.h>

namespace kappaflow::python {

void bind_errors(nanobind::module_& m);
void bind_inputs(nanobind::module_& m);
void bind_field(nanobind::module_& m);
void bind_velocity(nanobind::module_& m);
void bind_texture(nanobind::module_& m);
void bind_tracker(nanobind::module_& m);
void bind_simulation(nanobind::module_& m);

}  // namespace kappaflow::python
