// A velocity method that is not the library's; and what docs/extending.md shows of it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "surface/field/rigid_particles.h"
#include "surface/remesh/initial_mesh.h"
#include "surface/tracker/surface_tracker.h"

namespace kappaflow {
namespace {

namespace fs = std::filesystem;

}  // namespace

void evaluate_height(const Field& field, const SurfacePoints& points, const VelocityOptions& options,
                     SurfaceVelocities& result);  // height.cpp

namespace {

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// The corners of a box with edges of 0.4, 0.6 and 0.2.
FieldParticles box() {
  FieldParticles particles;
  for (int k = 0; k < 8; ++k)
    particles.position.push_back(Vec3(k & 1 ? 0.2 : -0.2, k & 2 ? 0.3 : -0.3, k & 4 ? 0.1 : -0.1));
  particles.velocity.assign(8, Vec3::Zero());
  particles.sigma.assign(8, 0.8);
  particles.weight.assign(8, 1);
  particles.weight_rate.assign(8, 0);
  return particles;
}

TEST(Extending, AMethodOfAProgramsOwnIsTracked) {
  const TrackerOptions options{.method = evaluate_height,
                               .velocity = {.damping = 1e-3, .speed_limit = 4},
                               .fairing = {.iterations = 0}};
  const SteadyMotion turning{.velocity = {}, .angular_velocity = Vec3(0, 1, 0)};
  const auto part = [&](int n) { return RigidParticles(box(), 0.5, turning, 0.02 * n, 0.02 * (n + 1)); };
  auto first = part(0);
  SurfaceTracker tracker(initial_mesh(*first.at(0), 0.2, {}), options);
  double moved = 0, height_change = 0;
  for (int n = 0; n < 10; ++n) {
    auto motion = part(n);
    EXPECT_EQ(tracker.step(motion).unprojected, 0u);
  }
  const TriangleMesh& mesh = tracker.mesh();
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    moved = std::max(moved, (mesh.position[v] - mesh.rest_position[v]).norm());
    height_change = std::max(height_change, std::abs(mesh.position[v].y() - mesh.rest_position[v].y()));
  }
  EXPECT_GT(moved, 0.02);
  EXPECT_LT(height_change, 0.01 * moved);
}

TEST(Extending, ThePageShowsThisCode) {
  const fs::path source = KAPPAFLOW_SOURCE_DIR;
  const std::string page = text_of(source / "docs/extending.md");
  EXPECT_NE(page.find(fmt::format("```cpp\n{}```", text_of(source / "tests/extending/height.cpp"))),
            std::string::npos);
}

}  // namespace
}  // namespace kappaflow
