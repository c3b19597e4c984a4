// A scene in motion.
#include "tools/runs/simulation.h"

#include <fmt/format.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/errors.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/exclusive.h"
#include "python/frame.h"
#include "surface/tracker/rest_pair.h"

namespace kappaflow::python {
namespace {

/// A scene, and how far it has come.
struct RunningScene {
  explicit RunningScene(PreparedScene prepared) : scene(prepared.scene), simulation(std::move(prepared)) {
    if (scene.output.rest_interval > 0) rest_pair.emplace(simulation.surfaces(), scene.output.rest_interval);
    arrive_at(0);
  }

  void arrive_at(int reached) {
    frame = reached;
    if (rest_pair) rest_pair->update(simulation.surfaces(), frame);
  }

  Scene scene;
  Simulation simulation;
  std::optional<RestPair> rest_pair;
  int frame = 0;
};

using Running = Exclusive<RunningScene>;

/// file: of the scene, or beside which its meshes lie where `text` is given.
PreparedScene prepared(const std::string& file, const std::optional<std::string>& text,
                       const std::optional<std::vector<std::string>>& methods,
                       std::optional<double> duration) {
  Scene scene = text ? parse_scene(*text, file) : load_scene(file);
  if (methods) scene.surface.methods = *methods;
  if (duration) scene.duration = *duration;
  if (scene.surface.methods.empty())
    throw InvalidInput(
        fmt::format("{}: no velocity method to track with; name one in [surface] methods or in methods, "
                    "\"material\" where only the liquid matters",
                    scene.file.string()));
  return prepare(std::move(scene));
}

void make_running(Running* self, const std::string& file, const std::optional<std::string>& text,
                  const std::optional<std::vector<std::string>>& methods, std::optional<double> duration) {
  new (self) Running("Simulation", [&] { return RunningScene(prepared(file, text, methods, duration)); });
}

bool interrupted() {
  const nb::gil_scoped_acquire lock;
  return PyErr_CheckSignals() != 0;
}

/// Throws InvalidInput at the end of the scene.
double next_time(const RunningScene& running) {
  if (running.frame == last_frame_of(running.scene))
    throw InvalidInput(fmt::format("{}: the scene is at its end, t = {:.6g} s", running.scene.file.string(),
                                   running.simulation.liquid().time()));
  return frame_time(running.scene, running.frame + 1);
}

/// One step of the liquid towards the next frame.
FluidStep step(Running& self) {
  self.use(next_time);
  return self.move_on([](RunningScene& running) {
    FluidStep done;
    const bool arrived = running.simulation.advance(next_time(running), [&](const FluidStep& fluid) {
      done = fluid;
      return false;
    });
    if (arrived) running.arrive_at(running.frame + 1);
    return done;
  });
}

/// To the next frame; an interrupt (Ctrl-C) ends it after the current step, and the next call goes on.
void advance(Running& self) {
  self.use(next_time);
  const bool arrived = self.move_on([](RunningScene& running) {
    const bool there =
        running.simulation.advance(next_time(running), [](const FluidStep&) { return !interrupted(); });
    if (there) running.arrive_at(running.frame + 1);
    return there;
  });
  if (!arrived) throw nb::python_error();
}

/// Of the particles now, by id; also after a failure, to see where it was.
NamedArrays particles(Running& self) {
  struct Arrays {
    Particles particles;
    std::vector<float> density, pressure;
    std::vector<int> source;
  };
  Arrays now = self.look([](const RunningScene& running) {
    ParticleFrame now = running.simulation.liquid().record().particles;
    return Arrays{std::move(now.particles), std::move(now.density), std::move(now.pressure),
                  std::move(now.source)};
  });
  NamedArrays arrays;
  arrays["id"] = array_of<std::int64_t>(std::move(now.particles.id));
  arrays["positions"] = vectors_of(std::move(now.particles.position));
  arrays["velocity"] = vectors_of(std::move(now.particles.velocity));
  arrays["density"] = array_of<float>(std::move(now.density));
  arrays["pressure"] = array_of<float>(std::move(now.pressure));
  arrays["source"] = array_of<int>(std::move(now.source));
  return arrays;
}

NamedArrays surface_arrays(Running& self, std::size_t surface) {
  return arrays_of(self.use(
      [&](const RunningScene& running) { return snapshot(running.simulation.surfaces(), surface); }));
}

/// Vertices and triangles of each wall, then of each body, where it is now.
auto walls(Running& self) {
  std::vector<TriangleSurface> surfaces =
      self.look([](const RunningScene& running) { return surfaces_of(running.simulation.solids_now()); });
  std::vector<std::tuple<VectorsOut, ArrayOut<int, 3>>> arrays;
  for (TriangleSurface& wall : surfaces)
    arrays.emplace_back(vectors_of(std::move(wall.vertices)), array_of<int, 3>(std::move(wall.triangles)));
  return arrays;
}

template <class Get>
auto property(const Get& get) {
  return [get](Running& self) { return self.look(get); };
}

}  // namespace

void bind_simulation(nb::module_& m) {
  nb::class_<FluidStep>(m, "FluidStep", "What one time step of the liquid did.")
      .def_ro("time_step", &FluidStep::time_step, "[s].")
      .def_ro("density_iterations", &FluidStep::density_iterations)
      .def_ro("divergence_iterations", &FluidStep::divergence_iterations)
      .def_ro("viscosity_iterations", &FluidStep::viscosity_iterations)
      .def_ro("viscosity_error", &FluidStep::viscosity_error,
              "At most 1, or the solve has not converged [1].")
      .def_ro("density_error_mean", &FluidStep::density_error_mean,
              "Mean of max(rho/rho0 - 1, 0) over the particles [1].")
      .def_ro("density_error_max", &FluidStep::density_error_max, "Maximum likewise [1].")
      .def_ro("fastest", &FluidStep::fastest, "Largest particle speed [m/s].");
  nb::class_<Running>(m, "SimulationHandle")
      .def("__init__", make_running, nb::arg("file"), nb::arg("text").none(), nb::arg("methods").none(),
           nb::arg("duration").none())
      .def("step", step)
      .def("advance", advance)
      .def("particles", particles)
      .def("surface", surface_arrays, nb::arg("surface"))
      .def("walls", walls)
      .def_prop_ro("methods", property([](const RunningScene& r) { return r.scene.surface.methods; }))
      .def_prop_ro("title", property([](const RunningScene& r) { return r.scene.title; }))
      .def_prop_ro("frame", property([](const RunningScene& r) { return r.frame; }))
      .def_prop_ro("last_frame", property([](const RunningScene& r) { return last_frame_of(r.scene); }))
      .def_prop_ro("time", property([](const RunningScene& r) { return r.simulation.liquid().time(); }))
      .def_prop_ro("surface_time",
                   property([](const RunningScene& r) { return r.simulation.surfaces().time(); }))
      .def_prop_ro("sigma", property([](const RunningScene& r) {
                     return r.simulation.surfaces().field_options().sigma;
                   }))
      .def_prop_ro("threshold", property([](const RunningScene& r) {
                     return r.simulation.surfaces().field_options().threshold;
                   }));
}

}  // namespace kappaflow::python
