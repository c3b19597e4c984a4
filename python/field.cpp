// Eq. 12 at points that Python asks for.
#include <nanobind/stl/tuple.h>

#include <array>
#include <limits>
#include <memory>
#include <tuple>
#include <vector>

#include "core/parallel.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/field_handle.h"
#include "python/velocity.h"
#include "surface/field/curvature.h"
#include "surface/field/particle_motion.h"
#include "surface/remesh/initial_mesh.h"
#include "surface/tracker/tracked_surfaces.h"

namespace kappaflow::python {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The field, its sigma [m] and its threshold.
std::tuple<FieldHandle, double, double> make_field(const Particles& particles,
                                                   const SurfaceOptions& choices) {
  const nb::gil_scoped_release other_threads;
  const ParticleFieldOptions options = field_options(choices, particles.position, particles.scale);
  return {FieldHandle(particle_field(particles, options)), options.sigma, options.threshold};
}

/// evaluate(field, x) at each point x, while other Python threads run.
template <class Evaluate>
auto at_each(const FieldHandle& handle, const VectorsIn& points, const Evaluate& evaluate) {
  const std::shared_ptr<const Field> field = handle.get();
  const std::span<const Vec3> at = entries<Vec3>(points);
  const nb::gil_scoped_release other_threads;
  std::vector<decltype(evaluate(*field, at[0]))> results(at.size());
  parallel_for(at.size(), [&](std::size_t i) { results[i] = evaluate(*field, at[i]); });
  return results;
}

/// The array of one member of many structures. Rest: the shape of the member.
template <nb::ssize_t... Rest, class Structure, class Get>
ArrayOut<double, Rest...> member(const std::vector<Structure>& structures, const Get& get) {
  std::vector<decltype(get(structures[0]))> values;
  values.reserve(structures.size());
  for (const Structure& one : structures) values.push_back(get(one));
  return array_of<double, Rest...>(std::move(values));
}

NumbersOut values(const FieldHandle& field, const VectorsIn& points) {
  return array_of<double>(
      at_each(field, points, [](const Field& f, const Vec3& x) { return f.value_and_gradient(x).f; }));
}

/// All 27 third derivatives, f_abc at 9 a + 3 b + c.
std::array<double, 27> all_of(const ThirdDerivatives& C) {
  std::array<double, 27> all{};
  for (int c = 0; c < 3; ++c) {
    const Mat3 slice = C.contract(Vec3::Unit(c));
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) all[static_cast<std::size_t>(9 * a + 3 * b + c)] = slice(a, b);
  }
  return all;
}

auto jets(const FieldHandle& field, const VectorsIn& points) {
  const std::vector<Jet> jets =
      at_each(field, points, [](const Field& f, const Vec3& x) { return f.jet(x); });
  return std::tuple(
      member(jets, [](const Jet& j) { return j.f; }), member<3>(jets, [](const Jet& j) { return j.g; }),
      member<3, 3>(jets, [](const Jet& j) { return j.A; }),
      member<3, 3, 3>(jets, [](const Jet& j) { return all_of(j.C); }),
      member(jets, [](const Jet& j) { return j.f_t; }), member<3>(jets, [](const Jet& j) { return j.g_t; }),
      member<3, 3>(jets, [](const Jet& j) { return j.A_t; }),
      member(jets, [](const Jet& j) { return j.length_scale; }),
      member(jets, [](const Jet& j) { return j.fastest_in_reach; }));
}

/// nan where f has no gradient.
CurvatureJet curvature_or_nan(const Jet& jet) {
  const Vec3 nans = Vec3::Constant(kNan);
  return jet.g != Vec3::Zero() ? curvature_jet(jet) : CurvatureJet{kNan, kNan, nans, nans, kNan, kNan};
}

auto curvatures(const FieldHandle& field, const VectorsIn& points) {
  const std::vector<CurvatureJet> all =
      at_each(field, points, [](const Field& f, const Vec3& x) { return curvature_or_nan(f.jet(x)); });
  using Curvature = CurvatureJet;
  return std::tuple(member(all, [](const Curvature& c) { return c.K; }),
                    member(all, [](const Curvature& c) { return c.H; }),
                    member<3>(all, [](const Curvature& c) { return c.grad_K; }),
                    member<3>(all, [](const Curvature& c) { return c.grad_H; }),
                    member(all, [](const Curvature& c) { return c.K_t; }),
                    member(all, [](const Curvature& c) { return c.H_t; }));
}

VectorsOut material_velocities(const FieldHandle& field, const VectorsIn& points) {
  return vectors_of(at_each(field, points, [](const Field& f, const Vec3& x) -> Vec3 {
    return f.material_velocity(x).value_or(Vec3::Constant(kNan));
  }));
}

auto velocities(const FieldHandle& handle, const PointsHandle& points, const nb::object& method,
                const VelocityOptions& options) {
  const VelocityFunction evaluate = velocity_function(method);
  SurfaceVelocities result;
  {
    const std::shared_ptr<const Field> field = handle.get();
    const nb::gil_scoped_release other_threads;
    evaluate(*field, points.points(), options, result.sized(points.position.size()));
  }
  return std::tuple(vectors_of(std::move(result.velocity)), array_of<double>(std::move(result.confidence)));
}

auto project(const FieldHandle& field, const VectorsIn& points) {
  const std::vector<Projected> found = at_each(field, points, [](const Field& f, const Vec3& x) {
    return kappaflow::project(f, x, ProjectionOptions{});
  });
  std::vector<unsigned char> converged;
  for (const Projected& one : found) converged.push_back(one.converged ? 1 : 0);
  return std::tuple(member<3>(found, [](const Projected& p) { return p.position; }),
                    member<3>(found, [](const Projected& p) { return p.gradient; }),
                    member(found, [](const Projected& p) { return p.residual; }),
                    array_of<unsigned char>(std::move(converged)));
}

auto surface(const FieldHandle& handle, double edge_length) {
  TriangleMesh mesh;
  {
    const std::shared_ptr<const Field> field = handle.get();
    const nb::gil_scoped_release other_threads;
    mesh = initial_mesh(*field, edge_length, ProjectionOptions{});
  }
  return std::tuple(vectors_of(std::move(mesh.position)), array_of<int, 3>(std::move(mesh.triangles)));
}

}  // namespace

void bind_field(nb::module_& m) {
  m.def("make_field", make_field, nb::arg("particles"), nb::arg("options"));
  nb::class_<FieldHandle>(m, "FieldHandle")
      .def_prop_ro("time", [](const FieldHandle& field) { return field.get()->time(); })
      .def_prop_ro("length_scale", [](const FieldHandle& field) { return field.get()->length_scale(); })
      .def("values", values, nb::arg("points"))
      .def("jets", jets, nb::arg("points"))
      .def("curvatures", curvatures, nb::arg("points"))
      .def("material_velocities", material_velocities, nb::arg("points"))
      .def("velocities", velocities, nb::arg("points"), nb::arg("method"), nb::arg("options"))
      .def("project", project, nb::arg("points"))
      .def("surface", surface, nb::arg("edge_length"));
}

}  // namespace kappaflow::python
