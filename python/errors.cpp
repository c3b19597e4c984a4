// core/errors.h as the exceptions of kappaflow/errors.py, in the same words.
#include "core/errors.h"

#include <exception>

#include "python/bindings.h"

namespace kappaflow::python {
namespace {

void raise(const char* name, const Error& error) {
  const nanobind::object type = nanobind::module_::import_("kappaflow.errors").attr(name);
  PyErr_SetString(type.ptr(), error.what());
}

void translate(const std::exception_ptr& thrown, void* /*unused*/) {
  try {
    std::rethrow_exception(thrown);
  } catch (const InvalidInput& error) {
    raise("InvalidInput", error);
  } catch (const SolverFailure& error) {
    raise("SolverFailure", error);
  } catch (const TopologyError& error) {
    raise("TopologyError", error);
  } catch (const IoError& error) {
    raise("IoError", error);
  } catch (const Error& error) {
    raise("Error", error);
  }
}

}  // namespace

void bind_errors(nanobind::module_& /*m*/) {
  nanobind::register_exception_translator(translate);
}

}  // namespace kappaflow::python
