// The ways in which a surface follows the liquid, by the names that scenes and the command line call them:
// tracked with a velocity, or meshed anew in every frame.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/named.h"
#include "surface/motion/velocity.h"

namespace kappaflow {

/// Where a mesh that is new in every frame has rest positions and sources from.
enum class FreshMesh {
  nearest,    ///< from the nearest point of the last frame's mesh
  particles,  ///< from the particles, where they were first: see OriginMap
  grid        ///< rest positions from a grid that the liquid's velocity carries them on: see RestGrid
};

/// How one surface follows the liquid.
using SurfaceMethod = std::variant<VelocityFunction, FreshMesh>;

/// Whether particles correct the rest positions that tracked meshes carry along.
enum class Anchor {
  none,
  particles  ///< in every frame, by those of the vertex's own side: see OriginMap
};

/// As scenes and the command line have them.
inline constexpr Named<Anchor> kAnchors[] = {{"none", Anchor::none}, {"particles", Anchor::particles}};

struct NamedSurfaceMethod {
  std::string_view name;
  std::string_view summary;  ///< one line for help texts
  SurfaceMethod method;
};

/// All of them, in the order in which help texts list them: velocity_methods(), then those without tracking.
std::span<const NamedSurfaceMethod> surface_methods();

std::vector<std::string_view> surface_method_names();

/// The methods of these names. Throws InvalidInput that lists the names for another one.
std::vector<SurfaceMethod> surface_methods_named(std::span<const std::string> names);

}  // namespace kappaflow
