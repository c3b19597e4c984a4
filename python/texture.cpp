// Colours and texture coordinates from rest positions.
#include "surface/measure/texture.h"

#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string>

#include "core/errors.h"
#include "python/arrays.h"
#include "python/bindings.h"

namespace kappaflow::python {
namespace {

ArrayOut<double, 2> coordinates(const VectorsIn& rest_position, const VectorsIn& first,
                                const std::string& projection) {
  const std::optional<TextureProjection> found = value_of(kTextureProjections, projection);
  if (!found)
    throw InvalidInput(fmt::format("projection: '{}'; allowed are planar, spherical, box", projection));
  return array_of<double, 2>(
      texture_coordinates(entries<Vec3>(rest_position), bounding_box(entries<Vec3>(first)), *found));
}

ArrayOut<unsigned char, 3> colours(const VectorsIn& rest_position, const std::array<double, 3>& origin,
                                   double edge) {
  if (!(edge > 0)) throw InvalidInput(fmt::format("edge: {}; a length above 0 is needed", edge));
  const Checker checker{Vec3(origin[0], origin[1], origin[2]), edge};
  return array_of<unsigned char, 3>(checker_colours(entries<Vec3>(rest_position), checker));
}

}  // namespace

void bind_texture(nb::module_& m) {
  m.def("texture_coordinates", coordinates, nb::arg("rest_positions"), nb::arg("first_positions"),
        nb::arg("projection"));
  m.def("checker_colours", colours, nb::arg("rest_positions"), nb::arg("origin"), nb::arg("edge"));
}

}  // namespace kappaflow::python
