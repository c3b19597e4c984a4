#include "tools/runs/check.h"

#include "core/errors.h"
#include "tests/tools/scratch.h"

namespace kappaflow {
namespace {

// The staircase of a thousand particles takes tens of megabytes, and any machine has them.
TEST(Check, ASceneThatDoesNotFitIsRefused) {
  const PreparedScene scene = prepare(load_scene(KAPPAFLOW_SOURCE_DIR "/scenes/staircase-small.toml"));
  EXPECT_NO_THROW(require_memory(scene, machine_memory()));
  const std::string message = message_of<InvalidInput>([&] { require_memory(scene, 1'000'000); });
  EXPECT_NE(message.find("staircase-small.toml: needs about 0.0"), std::string::npos) << message;
  EXPECT_NE(message.find(" GB of memory, there are 0.001 GB; a larger [fluid] spacing needs less"),
            std::string::npos)
      << message;
}

}  // namespace
}  // namespace kappaflow
