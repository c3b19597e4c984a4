#include "solver/wall_bodies.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "solver/boundary_sampling.h"

namespace kappaflow {
namespace {

/// The rule of the wall under whose surface the sample lies. heat: of the walls.
WallHeat heat_of(const WallSample& sample, std::span<const SolidWall> walls, std::span<const WallHeat> heat,
                 double spacing) {
  const Vec3 surface = sample.position + kWallDepth * spacing * sample.normal;
  double nearest = std::numeric_limits<double>::infinity();
  WallHeat result;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const double distance = std::abs(nearest_of_walls(walls.subspan(w, 1), surface).distance);
    if (distance < nearest) result = heat[w];
    nearest = std::min(distance, nearest);
  }
  return result;
}

/// All samples have this rule.
std::vector<WallHeat> heat_of(const RigidBody& body, std::size_t samples) {
  return body.heat == WallHeat() ? std::vector<WallHeat>() : std::vector<WallHeat>(samples, body.heat);
}

}  // namespace

std::vector<WallBody> wall_bodies(std::span<const SolidWall> walls, std::span<const WallHeat> heat,
                                  std::span<const RigidBody> rigid, double spacing) {
  std::vector<WallBody> bodies;
  std::vector<char> done(walls.size(), 0);
  for (std::size_t first = 0; first < walls.size(); ++first) {
    if (done[first]) continue;
    const BodyMotion& motion = walls[first].motion();
    std::vector<SolidWall> group;
    std::vector<WallHeat> rules;
    for (std::size_t w = first; w < walls.size(); ++w)
      if (walls[w].motion() == motion) {
        group.push_back(walls[w]);
        rules.push_back(w < heat.size() ? heat[w] : WallHeat());
        done[w] = 1;
      }
    bodies.push_back({sample_walls(group, spacing), motion});
    if (std::ranges::all_of(rules, [](const WallHeat& rule) { return rule == WallHeat(); })) continue;
    WallBody& body = bodies.back();
    body.heat.resize(body.samples.size());
    parallel_for(body.samples.size(),
                 [&](std::size_t b) { body.heat[b] = heat_of(body.samples[b], group, rules, spacing); });
  }
  for (const RigidBody& described : rigid) {
    std::vector<WallSample> samples = sample_walls({&described.solid, 1}, spacing);
    BodyMotion none;
    none.point = mass_properties(described.solid.surface()).centre;
    std::vector<WallHeat> rules = heat_of(described, samples.size());
    bodies.push_back({std::move(samples), none, std::move(rules), true});
  }
  return bodies;
}

std::vector<SolidWall> all_solids(std::span<const SolidWall> walls, std::span<const RigidBody> bodies) {
  std::vector<SolidWall> solids(walls.begin(), walls.end());
  for (const RigidBody& body : bodies) solids.push_back(body.solid);
  return solids;
}

}  // namespace kappaflow
