// kappaflow._core: the compiled half of the Python package. The other half, kappaflow/*.py, checks what users
// hand over and holds the documentation.
#include <nanobind/nanobind.h>
#include <tbb/global_control.h>

#include <memory>

#include "core/version.h"
#include "python/bindings.h"

namespace kappaflow::python {
namespace {

/// 0: as many as there are cores.
void set_threads(std::size_t count) {
  static std::unique_ptr<tbb::global_control> limit;
  limit.reset();
  if (count > 0)
    limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, count);
}

}  // namespace
}  // namespace kappaflow::python

NB_MODULE(_core, m) {
#ifdef __AVX2__
  if (!__builtin_cpu_supports("avx2"))
    throw nanobind::import_error("kappaflow: this build needs a processor with AVX2; see docs/python.md");
#endif
  m.attr("version") = kappaflow::kVersion;
  m.def("set_threads", kappaflow::python::set_threads, nanobind::arg("count"));
  kappaflow::python::bind_errors(m);
  kappaflow::python::bind_inputs(m);
  kappaflow::python::bind_velocity(m);
  kappaflow::python::bind_field(m);
  kappaflow::python::bind_texture(m);
  kappaflow::python::bind_tracker(m);
  kappaflow::python::bind_simulation(m);
}
