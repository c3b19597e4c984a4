#include "tools/runs/check.h"

#include "core/errors.h"
#include "core/machine_memory.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

// The staircase of a thousand particles takes tens of megabytes, and any machine has them.
TEST(Check, ASceneThatDoesNotFitIsRefused) {
  const PreparedScene prepared = prepare(load_scene(KAPPAFLOW_SOURCE_DIR "/scenes/staircase-small.toml"));
  const std::size_t needed = estimate(prepared, 1).memory_bytes;
  EXPECT_NO_THROW(require_memory(prepared.scene, needed, machine_memory()));
  const std::string message =
      message_of<InvalidInput>([&] { require_memory(prepared.scene, needed, 1'000'000); });
  EXPECT_NE(message.find("staircase-small.toml: needs about 0.0"), std::string::npos) << message;
  EXPECT_NE(message.find(" GB of memory, there are 0.001 GB; a larger [fluid] spacing needs less"),
            std::string::npos)
      << message;
}

TEST(Check, SaysWhatFlowsInAndOutAndWhatBodiesWeigh) {
  const std::string text =
      check_text(prepare(load_scene(KAPPAFLOW_SOURCE_DIR "/tests/data/every_key.toml")), 1);
  for (const char* line :
       {"emitter at (6, 0, 0) m, 0.5 to 1.25 m/s towards (0, -1, 0), 0.5 to 1.25 m3/s (16 "
        "particles a layer), "
        "parabolic profile, moving\n",
        "    body    box from (2, 6, 5) to (3, 7, 6) m, 12.5 kg, friction 0.5, heat flux 50 W/m2\n",
        "kg (2500 kg/m3), friction 0.25, moving, at 400 K\n",
        "    outflow box from (7, -2, -3) to (8, 2, 3) m\n",
        "    outflow sphere of radius 0.7 m at (-9, 1, 2) m\n",
        "    outflow cylinder of radius 0.3 m from (9, 0, 0) to (9, 0, 4) m\n"})
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  PreparedScene tilted = prepare(load_scene(KAPPAFLOW_SOURCE_DIR "/scenes/staircase-small.toml"));
  EXPECT_EQ(check_text(tilted, 1).find("gravity"), std::string::npos);
  tilted.scene.fluid.gravity_table.keys = {{0, Vec3(0, -9.81, 0)}, {0.5, Vec3(3, -9, 0)}};
  EXPECT_NE(check_text(tilted, 1).find("    gravity (0, -9.81, 0) at 0 s, (3, -9, 0) at 0.5 s m/s2\n"),
            std::string::npos);
}

}  // namespace
}  // namespace kappaflow
