#include "tools/runs/run.h"

#include <fmt/format.h>
#include <vtkPolyData.h>

#include "core/errors.h"
#include "scenes/scene.h"
#include "tests/open_counter.h"
#include "tests/tools/scratch.h"
#include "tests/vtk_reader.h"
#include "tools/runs/run_driver.h"
#include "tools/runs/run_folder.h"
#include "tools/runs/scene_frames.h"

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

/// A liquid whose surfaces fail on the way to the first frame.
class FailingFrames final : public SceneFrames {
 public:
  using SceneFrames::SceneFrames;
  bool advance(int frame, const Watch& watch) override {
    SceneFrames::advance(frame, watch);
    throw InvalidInput("there is no surface");
  }
};

TEST_F(RunScene, SurfacesThatFailSayWhenAndLeaveTheParticles) {
  const Scene scene = load_scene(file("cube.toml", R"(duration = 0.02
[fluid]
spacing = 0.1
kinematic_viscosity = 1.0
[[fluid.block]]
shape = "box"
lower = [0.0, 0.0, 0.0]
upper = [0.3, 0.3, 0.3]
[output]
frames_per_second = 50.0
)"));
  PreparedScene prepared = prepare(scene);
  FailingFrames frames(prepared, own_liquid(prepared));
  const std::filesystem::path out = folder / "out";
  RunFolder run(out, scene.surface.methods, false);
  RunDriver driver(frames, run,
                   {.command = "run",
                    .title = {},
                    .output = scene.output,
                    .methods = scene.surface.methods,
                    .formats = {},
                    .quiet = true,
                    .save_beginning = [](StateWriter&) {}},
                   Stopwatch());
  driver.start();
  const std::string message = message_of<Error>([&] { driver.advance(InterruptGuard()); });
  EXPECT_EQ(
      message,
      fmt::format("the surfaces failed at t = 0.02 s, step {}: there is no surface; its particles are in {}",
                  frames.steps(), (out / "failure.vtp").string()));
  EXPECT_EQ(read_vtp(out / "failure.vtp")->GetNumberOfPoints(), 27);
}

}  // namespace
}  // namespace kappaflow
