#include "scenes/solids.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string_view>
#include <variant>

#include "scenes/heat.h"
#include "scenes/materials.h"
#include "solver/boundary_sampling.h"

namespace kappaflow {
namespace {

constexpr double kMaxMass = 1e12;    // [kg]
constexpr double kMaxFriction = 10;  // [1]

StairsShape read_stairs(TomlTable& t) {
  StairsShape stairs;
  stairs.steps = t.integer("steps", 1, 10000, stairs.steps);
  stairs.rise = t.number("rise", length_range());
  stairs.run = t.number("run", length_range());
  stairs.landing = t.number("landing", length_range());
  stairs.floor = t.number("floor", length_range());
  stairs.width = t.number("width", length_range());
  stairs.thickness = t.number("thickness", length_range());
  stairs.origin = t.vector("origin", "m", stairs.origin);
  t.finish();
  return stairs;
}

BasinShape read_basin(TomlTable& t) {
  const double thickness = t.number("thickness", length_range());
  const BoxShape space = read_box(t);
  return {space.lower, space.upper, thickness};
}

/// Of the thinnest part, where the shape says it [m].
struct Thickness {
  double operator()(const BoxShape& box) const { return (box.upper - box.lower).minCoeff(); }
  double operator()(const BasinShape& basin) const { return basin.thickness; }
  double operator()(const StairsShape& stairs) const { return std::min(stairs.thickness, stairs.width); }
  double operator()(const auto&) const { return std::numeric_limits<double>::infinity(); }
};

/// The solver lays particles below a solid's surface, and both sides need room. Boxes and stairs are checked
/// here, where the line is known; the other shapes by the solver.
void check_thickness(std::string_view name, double thinnest, const SourcePosition& where, double spacing) {
  const double allowed = kThinnestWall * spacing;
  if (thinnest < allowed)
    throw InvalidInput(
        where, fmt::format("the {} is {:.6g} m thick; allowed: at least {} particle spacings, {:.6g} m", name,
                           thinnest, kThinnestWall, allowed));
}

}  // namespace

NumberRange length_range() {
  return positive("m", kMaxLength);
}

BoxShape read_box(TomlTable& t) {
  BoxShape box{t.vector("lower", "m"), t.vector("upper", "m")};
  t.finish();
  if (!(box.lower.array() < box.upper.array()).all())
    t.refuse("upper", fmt::format("a corner above lower, [{}, {}, {}] [m], in every component", box.lower[0],
                                  box.lower[1], box.lower[2]));
  return box;
}

SphereShape read_sphere(TomlTable& t) {
  SphereShape sphere{t.vector("center", "m"), t.number("radius", length_range())};
  t.finish();
  return sphere;
}

CylinderShape read_cylinder(TomlTable& t) {
  CylinderShape cylinder{t.vector("from", "m"), t.vector("to", "m"), t.number("radius", length_range())};
  t.finish();
  if (cylinder.from == cylinder.to) t.refuse("to", "a point other than from");
  return cylinder;
}

MeshShape read_mesh(TomlTable& t) {
  MeshShape mesh;
  const std::filesystem::path file = t.text("file");
  mesh.scale = t.number("scale", positive("m", kMaxLength), mesh.scale);
  mesh.translation = t.vector("translation", "m", mesh.translation);
  t.finish();
  mesh.file = std::filesystem::path(t.where().file).parent_path() / file;
  return mesh;
}

BodyMotion read_motion(TomlTable& body) {
  BodyMotion motion;
  std::vector<TomlTable> keys = body.tables("motion");
  if (keys.empty()) return motion;
  motion.axis = body.vector("axis", "", motion.axis);
  motion.point = body.vector("point", "m", motion.point);
  if (!(motion.axis.norm() > 1e-12)) body.refuse("axis", "a direction, not the zero vector");
  motion.axis.normalize();
  for (TomlTable& t : keys) {
    const bool first = motion.keys.empty();
    BodyMotion::Key key;
    key.time = t.number("time", non_negative("s", kMaxTime), first ? std::optional<double>(0) : std::nullopt);
    key.velocity = t.vector("velocity", "m/s", key.velocity);
    key.angular_velocity =
        t.number("angular_velocity", {-kMaxSpeed, kMaxSpeed, false, "rad/s"}, key.angular_velocity);
    t.finish();
    if (key.velocity.norm() > kMaxSpeed)
      t.refuse("velocity", fmt::format("at most {} m/s in length", kMaxSpeed));
    if (!first && key.time <= motion.keys.back().time)
      t.refuse("time", fmt::format("above {} s, the time before", motion.keys.back().time));
    motion.keys.push_back(key);
  }
  return motion;
}

Wall read_wall(TomlTable t, FluidOptions& fluid) {
  enum class Kind { box, sphere, cylinder, basin, stairs, mesh };
  static constexpr Named<Kind> kKinds[] = {{"box", Kind::box},           {"sphere", Kind::sphere},
                                           {"cylinder", Kind::cylinder}, {"basin", Kind::basin},
                                           {"stairs", Kind::stairs},     {"mesh", Kind::mesh}};
  const Kind kind = t.choice("shape", kKinds, {});
  Wall wall;
  wall.where = t.where();
  wall.motion = read_motion(t);
  const WallHeat heat = read_wall_heat(t, fluid.heat);
  if (fluid.heat) fluid.heat->walls.push_back(heat);
  if (kind == Kind::box) wall.shape = read_box(t);
  if (kind == Kind::sphere) wall.shape = read_sphere(t);
  if (kind == Kind::cylinder) wall.shape = read_cylinder(t);
  if (kind == Kind::basin) wall.shape = read_basin(t);
  if (kind == Kind::stairs) wall.shape = read_stairs(t);
  if (kind == Kind::mesh) wall.shape = read_mesh(t);
  check_thickness("wall", std::visit(Thickness(), wall.shape), wall.where, fluid.spacing);
  return wall;
}

SceneBody read_body(TomlTable t, const FluidOptions& fluid) {
  enum class Kind { box, sphere, cylinder, mesh };
  static constexpr Named<Kind> kKinds[] = {
      {"box", Kind::box}, {"sphere", Kind::sphere}, {"cylinder", Kind::cylinder}, {"mesh", Kind::mesh}};
  const Kind kind = t.choice("shape", kKinds, {});
  SceneBody body;
  body.where = t.where();
  if (t.has("density")) body.density = t.number("density", positive("kg/m3", kMaxDensity));
  if (t.has("mass")) body.mass = t.number("mass", positive("kg", kMaxMass));
  body.velocity = t.vector("velocity", "m/s", body.velocity);
  body.angular_velocity = t.vector("angular_velocity", "rad/s", body.angular_velocity);
  body.friction = t.number("friction", non_negative("", kMaxFriction), body.friction);
  body.heat = read_wall_heat(t, fluid.heat);
  if (kind == Kind::box) body.shape = read_box(t);
  if (kind == Kind::sphere) body.shape = read_sphere(t);
  if (kind == Kind::cylinder) body.shape = read_cylinder(t);
  if (kind == Kind::mesh) body.shape = read_mesh(t);
  if (body.density && body.mass) t.refuse("mass", "either a density or a mass, not both");
  if (!body.density && !body.mass)
    throw InvalidInput(body.where,
                       "missing the density of a [[body]]; required: either density [kg/m3] or mass [kg]");
  if (body.velocity.norm() > kMaxSpeed)
    t.refuse("velocity", fmt::format("at most {} m/s in length", kMaxSpeed));
  if (body.angular_velocity.norm() > kMaxSpeed)
    t.refuse("angular_velocity", fmt::format("at most {} rad/s in length", kMaxSpeed));
  check_thickness("body", std::visit(Thickness(), body.shape), body.where, fluid.spacing);
  return body;
}

}  // namespace kappaflow
