// The arrays over a mesh's vertices, and by which rule edits of the mesh carry each of them along.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <variant>
#include <vector>

#include "core/types.h"

namespace kappaflow {

/// What an edit gives a new vertex. One that comes from nowhere, with a piece of the surface that appears,
/// gets the array's `fresh` value whatever the rule.
enum class Carry {
  interpolate,  ///< the blend of the entries of the vertices around
  nearest,      ///< the entry of the nearest of them: for names and numbers of things
  recompute     ///< the array's `fresh` value, until whoever owns the array computes it anew
};

/// Where a new vertex comes from: a convex combination of up to three vertices.
struct VertexBlend {
  std::array<int, 3> vertex;
  std::array<double, 3> weight;  ///< sum 1
};

/// sum_i weight_i values[vertex_i]
template <class T>
T blended(const std::vector<T>& values, const VertexBlend& from) {
  return from.weight[0] * values[from.vertex[0]] + from.weight[1] * values[from.vertex[1]] +
         from.weight[2] * values[from.vertex[2]];
}

/// The vertex with the largest weight, the first of them if there are several.
inline int heaviest(const VertexBlend& from) {
  return from.vertex[std::ranges::max_element(from.weight) - from.weight.begin()];
}

/// The entry of a new vertex by the rule; `from` is null where it comes from nowhere.
template <class T>
T carried(const std::vector<T>& values, Carry carry, const T& fresh, const VertexBlend* from) {
  if (from == nullptr || carry == Carry::recompute) return fresh;
  if constexpr (!std::is_integral_v<T>)
    if (carry == Carry::interpolate) return blended(values, *from);
  return values[heaviest(*from)];
}

/// An array that a user of a mesh adds to it; one entry a vertex.
struct VertexArray {
  template <class T>
  struct Of {
    std::vector<T> values;
    T fresh;

    /// See core/saved_state.h.
    template <class Archive>
    void serialize(Archive& archive) {
      archive(values, fresh);
    }
  };

  std::string name;
  Carry carry = Carry::interpolate;
  std::variant<Of<double>, Of<Vec3>, Of<int>> data;

  /// See core/saved_state.h.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(name, carry, data);
  }
};

}  // namespace kappaflow
