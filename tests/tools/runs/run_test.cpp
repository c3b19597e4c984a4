#include "tools/runs/run.h"

#include "tests/open_counter.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

class RunScene : public Scratch {};

// The wall and the liquid are the same file.
TEST_F(RunScene, OpensTheSceneAndItsMeshOnce) {
  const auto scene = file("cubes.toml", R"(duration = 0.02
[fluid]
spacing = 0.1
kinematic_viscosity = 1.0
[[fluid.block]]
shape = "mesh"
file = "cube.obj"
scale = 0.5
translation = [0.25, 1.0, 0.25]
[[wall]]
shape = "mesh"
file = "cube.obj"
[output]
frames_per_second = 50.0
)");
  const auto mesh = file("cube.obj", bytes_of(KAPPAFLOW_SOURCE_DIR "/tests/data/meshes/cube.obj"));
  test::OpenCounter scene_opened(scene), mesh_opened(mesh);
  if (!mesh_opened.works()) GTEST_SKIP() << "the system does not say who opens a file";
  RunOptions options;
  options.scene = scene;
  options.folder = folder / "out";
  options.quiet = true;
  EXPECT_EQ(run_scene(options).frames.size(), 2u);
  EXPECT_EQ(scene_opened.count(), 1);
  EXPECT_EQ(mesh_opened.count(), 1);
}

}  // namespace
}  // namespace kappaflow
